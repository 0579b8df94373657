#include "tree/obj_assembler.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace snowbough::tree {
namespace {

constexpr int64_t kMost = std::numeric_limits<int32_t>::max();

const char* name_of(ObjIndex kind) {
  switch (kind) {
    case ObjIndex::kVertex:
      return "vertex";
    case ObjIndex::kUv:
      return "texture coordinate";
    default:
      return "normal";
  }
}

}  // namespace

int32_t ObjAssembler::NameTable::index(std::vector<std::string>& names, const std::string& name) {
  const auto [found, added] = numbers_.try_emplace(name, static_cast<int32_t>(names.size()));
  if (added) names.push_back(name);
  return found->second;
}

ObjAssembler::ObjAssembler(std::string name) : name_(std::move(name)) {}

ObjCounts ObjAssembler::counts() const {
  return {{static_cast<int64_t>(scene_.positions.size()), static_cast<int64_t>(scene_.uvs.size()),
           normal_count_}};
}

void ObjAssembler::append(const ObjFragment& fragment) {
  const size_t first_corner = scene_.corner_vertex.size();
  check_room(fragment);
  append_runs(fragment);
  append_corners(fragment);
  // These stand before the line at which the fragment was given up.
  resolve(fragment, first_corner);
  if (!fragment.error.empty()) fail(line_count_ + fragment.error_line, fragment.error);

  const ObjScene& part = fragment.scene;
  scene_.positions.insert(scene_.positions.end(), part.positions.begin(), part.positions.end());
  scene_.uvs.insert(scene_.uvs.end(), part.uvs.begin(), part.uvs.end());
  scene_.material_libraries.insert(scene_.material_libraries.end(), part.material_libraries.begin(),
                                   part.material_libraries.end());
  scene_.short_faces += part.short_faces;
  scene_.loose_elements += part.loose_elements;
  normal_count_ += fragment.normal_count;
  append_forward(fragment);
  line_count_ += fragment.line_count;
}

ObjScene ObjAssembler::finish() {
  const ObjCounts counts = this->counts();
  for (const ObjIndex kind : {ObjIndex::kVertex, ObjIndex::kUv, ObjIndex::kNormal}) {
    const int64_t count = counts.of[static_cast<int>(kind)];
    for (const ForwardIndex& entry : forward_[static_cast<int>(kind)]) {
      if (entry.index > count) {
        fail(entry.line, std::string(name_of(kind)) + " index " + std::to_string(entry.index) +
                             " is out of range (the file has " + std::to_string(count) + ")");
      }
    }
  }
  if (scene_.positions.empty() && scene_.face_count() == 0) {
    throw std::invalid_argument(
        name_ + ": holds no vertices and no faces; it is empty or no Wavefront OBJ file");
  }
  if (scene_.face_count() == 0) {
    throw std::invalid_argument(name_ +
                                ": holds vertices but no faces; export the tree as polygons");
  }
  return std::move(scene_);
}

void ObjAssembler::fail(int64_t line, const std::string& what) const {
  throw std::invalid_argument(name_ + ":" + std::to_string(line) + ": " + what);
}

void ObjAssembler::check_room(const ObjFragment& fragment) const {
  const auto check = [&](size_t before, size_t more, const char* what) {
    if (static_cast<int64_t>(before + more) > kMost) {
      fail(line_count_ + fragment.line_count, std::string("more than 2147483647 ") + what);
    }
  };
  check(scene_.positions.size(), fragment.scene.positions.size(), "vertices");
  check(scene_.uvs.size(), fragment.scene.uvs.size(), "texture coordinates");
  check(scene_.corner_vertex.size(), fragment.scene.corner_vertex.size(), "face corners");
}

void ObjAssembler::append_runs(const ObjFragment& fragment) {
  const ObjScene& part = fragment.scene;
  std::vector<int32_t> names;
  for (const std::string& name : part.names) names.push_back(groups_.index(scene_.names, name));
  std::vector<int32_t> materials;
  for (const std::string& name : part.materials) {
    materials.push_back(materials_.index(scene_.materials, name));
  }
  const auto number = [](int32_t local, const std::vector<int32_t>& numbers, int32_t before) {
    if (local == ObjFragment::kInherited) return before;
    return local < 0 ? -1 : numbers[local];
  };
  const auto resolved = [&](const FaceRun& run) {
    return FaceRun{scene_.face_count() + run.first_face, number(run.object, names, run_.object),
                   number(run.group, names, run_.group),
                   number(run.material, materials, run_.material)};
  };
  for (const FaceRun& local : part.runs) {
    const FaceRun run = resolved(local);
    if (scene_.runs.empty() || run.group != scene_.runs.back().group ||
        run.object != scene_.runs.back().object || run.material != scene_.runs.back().material) {
      scene_.runs.push_back(run);
    }
  }
  run_ = resolved(fragment.last);
}

void ObjAssembler::append_corners(const ObjFragment& fragment) {
  const ObjScene& part = fragment.scene;
  const size_t first_corner = scene_.corner_vertex.size();
  scene_.corner_vertex.insert(scene_.corner_vertex.end(), part.corner_vertex.begin(),
                              part.corner_vertex.end());
  if (!part.corner_uv.empty()) {
    scene_.corner_uv.resize(first_corner, -1);
    scene_.corner_uv.insert(scene_.corner_uv.end(), part.corner_uv.begin(), part.corner_uv.end());
  } else if (!scene_.corner_uv.empty()) {
    scene_.corner_uv.resize(scene_.corner_vertex.size(), -1);
  }
  const size_t first_face = scene_.face_begin.size();
  scene_.face_begin.insert(scene_.face_begin.end(), part.face_begin.begin() + 1,
                           part.face_begin.end());
  for (size_t f = first_face; f < scene_.face_begin.size(); ++f) {
    scene_.face_begin[f] += static_cast<int32_t>(first_corner);
  }
}

void ObjAssembler::resolve(const ObjFragment& fragment, size_t first_corner) {
  const ObjCounts before = counts();
  for (const RelativeIndex& entry : fragment.relative) {
    const int64_t count = before.of[static_cast<int>(entry.kind)] + entry.count;
    if (entry.value < -count) {
      fail(line_count_ + entry.line, std::string(name_of(entry.kind)) + " index " +
                                         std::to_string(entry.value) + " is out of range (" +
                                         std::to_string(count) + " so far)");
    }
    if (entry.corner < 0) continue;
    const auto index = static_cast<int32_t>(count + entry.value);
    if (entry.kind == ObjIndex::kVertex) scene_.corner_vertex[first_corner + entry.corner] = index;
    if (entry.kind == ObjIndex::kUv) scene_.corner_uv[first_corner + entry.corner] = index;
  }
}

void ObjAssembler::append_forward(const ObjFragment& fragment) {
  const ObjCounts known = counts();
  for (int kind = 0; kind < 3; ++kind) {
    std::vector<ForwardIndex>& all = forward_[kind];
    for (const ForwardIndex& entry : fragment.forward[kind]) {
      // What is there by now needs no remembering. The first offence in the file, if any, is always
      // larger than all before it, so that only running maxima need it.
      if (entry.index > known.of[kind] && (all.empty() || entry.index > all.back().index)) {
        all.push_back({entry.index, line_count_ + entry.line});
      }
    }
  }
}

}  // namespace snowbough::tree
