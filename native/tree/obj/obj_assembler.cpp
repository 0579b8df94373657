#include "tree/obj/obj_assembler.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "base/parallel_for.h"

namespace snowbough::tree {
namespace {

/// Reserved memory relative to the expected need.
constexpr double kRoom = 1.05;
constexpr int64_t kMaxCount = std::numeric_limits<int32_t>::max();

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

/// Enlarges the array, with room for the rest of the file extrapolated from its beginning.
template <typename T>
void grow(std::vector<T>& array, int64_t count, double share, const T& value = T()) {
  if (share > 0.0 && static_cast<size_t>(count) > array.capacity()) {
    array.reserve(static_cast<size_t>(static_cast<double>(count) * kRoom / share));
  }
  array.resize(static_cast<size_t>(count), value);
}

}  // namespace

int32_t ObjAssembler::NameTable::index(std::vector<std::string>& names, const std::string& name) {
  const auto [found, added] = numbers_.try_emplace(name, static_cast<int32_t>(names.size()));
  if (added) names.push_back(name);
  return found->second;
}

ObjAssembler::ObjAssembler(std::string name) : name_(std::move(name)) {}

/// Everything except the flat arrays.
void ObjAssembler::take(ObjFragment& fragment) {
  check_room(fragment);
  append_runs(fragment);
  // They come before the line at which parsing stopped.
  resolve(fragment);
  if (!fragment.error.empty()) fail(line_count_ + fragment.error_line, fragment.error);

  ObjScene& part = fragment.scene;
  scene_.material_libraries.insert(scene_.material_libraries.end(), part.material_libraries.begin(),
                                   part.material_libraries.end());
  scene_.short_faces += part.short_faces;
  scene_.loose_elements += part.loose_elements;
  counts_.of[static_cast<int>(ObjIndex::kVertex)] += static_cast<int64_t>(part.positions.size());
  counts_.of[static_cast<int>(ObjIndex::kUv)] += static_cast<int64_t>(part.uvs.size());
  counts_.of[static_cast<int>(ObjIndex::kNormal)] += static_cast<int64_t>(part.normals.size());
  corner_count_ += static_cast<int64_t>(part.corner_vertex.size());
  face_count_ += part.face_count();
  append_forward(fragment);
  line_count_ += fragment.line_count;
}

void ObjAssembler::append(std::vector<ObjFragment> fragments, double share, int threads) {
  struct Begin {
    size_t position, uv, normal, corner, face;
  };
  std::vector<Begin> begins;
  bool has_uvs = !scene_.corner_uv.empty();
  bool has_normals = !scene_.corner_normal.empty();
  for (ObjFragment& fragment : fragments) {
    begins.push_back({static_cast<size_t>(counts_.of[static_cast<int>(ObjIndex::kVertex)]),
                      static_cast<size_t>(counts_.of[static_cast<int>(ObjIndex::kUv)]),
                      static_cast<size_t>(counts_.of[static_cast<int>(ObjIndex::kNormal)]),
                      static_cast<size_t>(corner_count_), static_cast<size_t>(face_count_)});
    take(fragment);
    has_uvs = has_uvs || !fragment.scene.corner_uv.empty();
    has_normals = has_normals || !fragment.scene.corner_normal.empty();
  }
  grow(scene_.positions, counts_.of[static_cast<int>(ObjIndex::kVertex)], share);
  grow(scene_.uvs, counts_.of[static_cast<int>(ObjIndex::kUv)], share);
  grow(scene_.normals, counts_.of[static_cast<int>(ObjIndex::kNormal)], share);
  grow(scene_.corner_vertex, corner_count_, share);
  if (has_uvs) grow(scene_.corner_uv, corner_count_, share, -1);
  if (has_normals) grow(scene_.corner_normal, corner_count_, share, -1);
  grow(scene_.face_begin, int64_t{face_count_} + 1, share);
  base::parallel_for(fragments.size(), 1, {threads, {}}, [&](size_t i, size_t) {
    const ObjScene& part = fragments[i].scene;
    const Begin& begin = begins[i];
    const auto copy = [](const auto& from, auto& to, size_t at) {
      if (from.empty()) return;  // `to` may have no memory then
      std::copy(from.begin(), from.end(), to.begin() + static_cast<ptrdiff_t>(at));
    };
    copy(part.positions, scene_.positions, begin.position);
    copy(part.uvs, scene_.uvs, begin.uv);
    copy(part.normals, scene_.normals, begin.normal);
    copy(part.corner_vertex, scene_.corner_vertex, begin.corner);
    copy(part.corner_uv, scene_.corner_uv, begin.corner);
    copy(part.corner_normal, scene_.corner_normal, begin.corner);
    std::transform(part.face_begin.begin() + 1, part.face_begin.end(),
                   scene_.face_begin.begin() + static_cast<ptrdiff_t>(begin.face) + 1,
                   [&](int32_t corner) { return corner + static_cast<int32_t>(begin.corner); });
  });
}

ObjScene ObjAssembler::finish() {
  for (const ObjIndex kind : {ObjIndex::kVertex, ObjIndex::kUv, ObjIndex::kNormal}) {
    const int64_t count = counts_.of[static_cast<int>(kind)];
    for (const ForwardIndex& entry : forward_[static_cast<int>(kind)]) {
      if (entry.index > count) {
        fail(entry.line, std::string(name_of(kind)) + " index " + std::to_string(entry.index) +
                             " is out of range (the file has " + std::to_string(count) + ")");
      }
    }
  }
  if (counts_.of[static_cast<int>(ObjIndex::kVertex)] == 0 && face_count_ == 0) {
    throw std::invalid_argument(
        name_ + ": has no vertices and no faces; it is empty or not a Wavefront OBJ file");
  }
  if (face_count_ == 0) {
    throw std::invalid_argument(name_ + ": has vertices but no faces; export the tree as polygons");
  }
  return std::move(scene_);
}

void ObjAssembler::fail(int64_t line, const std::string& what) const {
  throw std::invalid_argument(name_ + ":" + std::to_string(line) + ": " + what);
}

void ObjAssembler::check_room(const ObjFragment& fragment) const {
  const auto check = [&](int64_t before, size_t more, const char* what) {
    if (before + static_cast<int64_t>(more) > kMaxCount) {
      fail(line_count_ + fragment.line_count, std::string("more than 2147483647 ") + what);
    }
  };
  check(counts_.of[static_cast<int>(ObjIndex::kVertex)], fragment.scene.positions.size(),
        "vertices");
  check(counts_.of[static_cast<int>(ObjIndex::kUv)], fragment.scene.uvs.size(),
        "texture coordinates");
  check(corner_count_, fragment.scene.corner_vertex.size(), "face corners");
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
    return FaceRun{face_count_ + run.first_face, number(run.object, names, run_.object),
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

void ObjAssembler::resolve(ObjFragment& fragment) const {
  for (const RelativeIndex& entry : fragment.relative) {
    const int64_t count = counts_.of[static_cast<int>(entry.kind)] + entry.count;
    if (entry.value < -count) {
      fail(line_count_ + entry.line, std::string(name_of(entry.kind)) + " index " +
                                         std::to_string(entry.value) + " is out of range (" +
                                         std::to_string(count) + " so far)");
    }
    if (entry.corner < 0) continue;
    const auto index = static_cast<int32_t>(count + entry.value);
    if (entry.kind == ObjIndex::kVertex) fragment.scene.corner_vertex[entry.corner] = index;
    if (entry.kind == ObjIndex::kUv) fragment.scene.corner_uv[entry.corner] = index;
    if (entry.kind == ObjIndex::kNormal) fragment.scene.corner_normal[entry.corner] = index;
  }
}

void ObjAssembler::append_forward(const ObjFragment& fragment) {
  for (int kind = 0; kind < 3; ++kind) {
    std::vector<ForwardIndex>& all = forward_[kind];
    for (const ForwardIndex& entry : fragment.forward[kind]) {
      // Indices to existing elements need no check later. The first error in the file, if any,
      // exceeds all indices before it, so only running maxima are kept.
      if (entry.index > counts_.of[kind] && (all.empty() || entry.index > all.back().index)) {
        all.push_back({entry.index, line_count_ + entry.line});
      }
    }
  }
}

}  // namespace snowbough::tree
