#include "tree/rims/membrane_patch.h"

#include <algorithm>
#include <iterator>

namespace snowbough::tree {
namespace {

/// Minimum area of a face relative to its first.
constexpr double kLeastArea = 0.04;
/// Number of times that corners of turned faces move to their neighbours' mean before the rims
/// around them are stopped, and fraction of the distance per time.
constexpr int kRelaxations = 10;
constexpr double kEvening = 0.6;

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// The smaller of a face's two triangle areas, doubled.
double least_area(const std::array<TubePlace, 4>& corners) {
  const glm::dvec2 a = difference(corners[0], corners[1]);
  const glm::dvec2 b = difference(corners[0], corners[2]);
  const glm::dvec2 c = difference(corners[0], corners[3]);
  return std::min(cross(a, b), cross(b, c));
}

void keep_once(std::vector<int32_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

}  // namespace

MembranePatch::MembranePatch(const Neighbours& neighbours, const std::vector<Rim>& rims,
                             std::span<const RimReach> reaches, UnrolledLimbs& unrolled,
                             Locals& locals)
    : neighbours_(neighbours),
      reaches_(reaches),
      unrolled_(unrolled),
      local_of_(locals.nodes),
      face_of_(locals.faces) {
  find_rims(rims);
  for (size_t j = 0; j < reaches.size(); ++j) {
    find_free(rims[reaches[j].junction], static_cast<int32_t>(j));
  }
  find_faces();
}

MembranePatch::~MembranePatch() {
  for (const MembraneNode& node : nodes) local_of_[node.vertex] = -1;
  for (const int32_t face : faces_) face_of_[face] = -1;
}

int32_t MembranePatch::add_node(int32_t vertex, int32_t junction) {
  local_of_[vertex] = static_cast<int32_t>(nodes.size());
  MembraneNode& node = nodes.emplace_back();
  node.vertex = vertex;
  node.junction = junction;
  return local_of_[vertex];
}

void MembranePatch::find_rims(const std::vector<Rim>& rims) {
  for (size_t j = 0; j < reaches_.size(); ++j) {
    const Rim& rim = rims[reaches_[j].junction];
    for (const RimPoint& point : rim) {
      const glm::dvec2 move = difference(point.base, point.target);
      if (local_of_[point.vertex] >= 0) {
        // Halfway, between two holes without a part of the parent between them.
        MembraneNode& node = nodes[local_of_[point.vertex]];
        node.step = 0.5 * (node.step + move);
      } else {
        MembraneNode& node = nodes[add_node(point.vertex, static_cast<int32_t>(j))];
        node.rim = true;
        node.step = move;
      }
    }
    for (size_t i = 0; i < rim.size(); ++i) {
      const int32_t here = local_of_[rim[i].vertex];
      const int32_t next = local_of_[rim[(i + 1) % rim.size()].vertex];
      nodes[here].after = next;
      nodes[next].before = here;
    }
  }
  rim_count = nodes.size();
}

void MembranePatch::find_free(const Rim& rim, int32_t number) {
  const RimReach& reach = reaches_[number];
  std::vector<int32_t> queue;
  for (const RimPoint& point : rim) queue.push_back(point.vertex);
  for (size_t i = 0; i < queue.size(); ++i) {
    for (const int32_t v : neighbours_.of(queue[i])) {
      if (local_of_[v] >= 0 || unrolled_.fixed[v] != 0 ||
          reach.from_centre(unrolled_.places[v]) > reach.radius) {
        continue;
      }
      const int depth = nodes[local_of_[queue[i]]].depth + 1;
      nodes[add_node(v, number)].depth = depth;
      queue.push_back(v);
    }
  }
}

void MembranePatch::find_faces() {
  for (const MembraneNode& node : nodes) {
    for (const int32_t f : neighbours_.faces_of(node.vertex)) faces_.push_back(f);
  }
  keep_once(faces_);
  for (const int32_t f : faces_) {
    face_of_[f] = static_cast<int32_t>(first_areas_.size());
    std::array<TubePlace, 4> corners;
    for (int k = 0; k < 4; ++k) corners[k] = unrolled_.places[unrolled_.quads[f][k]];
    first_areas_.push_back(least_area(corners));
  }
  face_marks_.assign(faces_.size(), 0);
}

void MembranePatch::spread(int sweeps) {
  for (MembraneNode& node : nodes) node.velocity = glm::dvec2(0.0);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (size_t i = rim_count; i < nodes.size(); ++i) {
      if (nodes[i].depth <= reaches_[nodes[i].junction].spread_depth) to_middle(nodes[i].vertex);
    }
  }
  find_turned();
  relax_turned();
  stop_turned();
  finish_step();
}

TubePlace MembranePatch::moved(int32_t vertex) const {
  TubePlace place = unrolled_.places[vertex];
  if (local_of_[vertex] >= 0) {
    const glm::dvec2& velocity = nodes[local_of_[vertex]].velocity;
    place.quarter += velocity.x;
    place.length += velocity.y;
  }
  return place;
}

std::array<TubePlace, 4> MembranePatch::moved_corners(const Quad& quad) const {
  return {moved(quad[0]), moved(quad[1]), moved(quad[2]), moved(quad[3])};
}

bool MembranePatch::turns(int32_t face) const {
  const double first = first_areas_[face_of_[face]];
  return least_area(moved_corners(unrolled_.quads[face])) < std::min(first, kLeastArea * first);
}

void MembranePatch::find_turned() {
  turned_.clear();
  for (size_t i = 0; i < faces_.size(); ++i) {
    const Quad& quad = unrolled_.quads[faces_[i]];
    const double first = first_areas_[i];
    if (least_area(moved_corners(quad)) < std::min(first, kLeastArea * first)) {
      turned_.push_back(faces_[i]);
    }
  }
}

void MembranePatch::relax_turned() {
  std::vector<int32_t> vertices, faces;
  for (int pass = 0; pass < kRelaxations && !turned_.empty(); ++pass) {
    vertices.clear();
    ++mark_;
    const auto take = [&](int32_t v) {
      if (local_of_[v] < 0 || nodes[local_of_[v]].mark == mark_) return;
      nodes[local_of_[v]].mark = mark_;
      vertices.push_back(v);
    };
    for (const int32_t f : turned_) {
      for (const int32_t corner : unrolled_.quads[f]) {
        take(corner);
        for (const int32_t v : neighbours_.of(corner)) take(v);
      }
    }
    faces.clear();
    const auto look_at = [&](int32_t f) {
      if (face_marks_[face_of_[f]] == mark_) return;
      face_marks_[face_of_[f]] = mark_;
      faces.push_back(f);
    };
    for (const int32_t f : turned_) look_at(f);
    for (const int32_t v : vertices) {
      if (!to_middle(v)) continue;
      for (const int32_t f : neighbours_.faces_of(v)) look_at(f);
    }
    turned_.clear();
    std::copy_if(faces.begin(), faces.end(), std::back_inserter(turned_),
                 [&](int32_t face) { return turns(face); });
  }
}

bool MembranePatch::to_middle(int32_t vertex) {
  if (local_of_[vertex] < 0) return false;
  MembraneNode& node = nodes[local_of_[vertex]];
  if (node.rim || node.stopped) return false;
  const RimReach& reach = reaches_[node.junction];
  const TubePlace now = moved(vertex);
  glm::dvec2 sum(0.0);
  double count = 0.0;
  for (const int32_t v : neighbours_.of(vertex)) {
    const glm::dvec2 offset = difference(now, moved(v));
    sum += offset * std::min(1.0, reach.spread / std::max(reach.metres(offset), 1e-30));
    count += 1.0;
  }
  if (count > 0.0) node.velocity += sum * (kEvening / count);
  return true;
}

void MembranePatch::stop_rims() {
  for (const int32_t f : turned_) {
    for (const int32_t v : unrolled_.quads[f]) {
      if (local_of_[v] >= 0 && nodes[local_of_[v]].rim) nodes[local_of_[v]].stopped = true;
    }
  }
}

void MembranePatch::stop_turned() {
  bool more = !turned_.empty();
  while (more) {
    more = false;
    for (const int32_t f : turned_) {
      for (const int32_t v : unrolled_.quads[f]) {
        if (local_of_[v] < 0) continue;
        MembraneNode& node = nodes[local_of_[v]];
        more |= !node.stopped || node.velocity != glm::dvec2(0.0);
        node.stopped = true;
        node.velocity = glm::dvec2(0.0);
      }
    }
    find_turned();
  }
}

void MembranePatch::finish_step() {
  for (MembraneNode& node : nodes) {
    unrolled_.places[node.vertex] = moved(node.vertex);
    node.stopped = false;
  }
}

}  // namespace snowbough::tree
