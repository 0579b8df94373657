#include "tree/surface_crossings.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <map>

#include "tree/surface_triangles.h"

namespace snowbough::tree {
namespace {

/// Faces around every vertex, flat.
struct VertexFaces {
  std::vector<int32_t> begin;
  std::vector<int32_t> faces;

  explicit VertexFaces(const Surface& surface) : begin(surface.vertices.size() + 1, 0) {
    for (const Quad& quad : surface.quads) {
      for (int32_t v : quad) {
        ++begin[v + 1];
      }
    }
    for (size_t v = 0; v + 1 < begin.size(); ++v) {
      begin[v + 1] += begin[v];
    }
    faces.resize(begin.back());
    std::vector<int32_t> next(begin.begin(), begin.end() - 1);
    for (size_t f = 0; f < surface.quads.size(); ++f) {
      for (int32_t v : surface.quads[f]) {
        faces[next[v]++] = static_cast<int32_t>(f);
      }
    }
  }
};

struct Box {
  glm::dvec3 low, high;

  bool meets(const Box& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y &&
           other.low.y <= high.y && low.z <= other.high.z && other.low.z <= high.z;
  }
};

class CrossingFinder {
 public:
  explicit CrossingFinder(const Surface& surface)
      : surface_(surface),
        around_(surface),
        face_stamp_(surface.quads.size(), -1),
        vertex_stamp_(surface.vertices.size(), -1),
        neighbours_known_(surface.quads.size(), 0) {
    points_.reserve(surface.vertices.size());
    for (const glm::dvec3& p : surface.vertices) {
      points_.push_back(glm::dvec3(glm::vec3(p)));
    }
    boxes_.reserve(surface.quads.size());
    for (const Quad& quad : surface.quads) {
      const glm::dvec3 &a = points_[quad[0]], &b = points_[quad[1]], &c = points_[quad[2]],
                       &d = points_[quad[3]];
      boxes_.push_back(
          {glm::min(glm::min(a, b), glm::min(c, d)), glm::max(glm::max(a, b), glm::max(c, d))});
    }
  }

  std::vector<std::pair<int32_t, int32_t>> at(const Junction& junction) {
    // Swept along x: each face meets only those that begin before it ends.
    std::vector<int32_t> faces = neighbourhood(junction);
    std::sort(faces.begin(), faces.end(), [&](int32_t f, int32_t g) {
      return boxes_[f].low.x != boxes_[g].low.x ? boxes_[f].low.x < boxes_[g].low.x : f < g;
    });
    std::vector<std::pair<int32_t, int32_t>> pairs;
    for (size_t i = 0; i < faces.size(); ++i) {
      const Box& box = boxes_[faces[i]];
      for (size_t j = i + 1; j < faces.size() && boxes_[faces[j]].low.x <= box.high.x; ++j) {
        if (box.meets(boxes_[faces[j]]) && !touch(faces[i], faces[j]) &&
            quads_cross(faces[i], faces[j])) {
          pairs.emplace_back(faces[i], faces[j]);
        }
      }
      for (int32_t other : crossing_neighbours(faces[i])) {
        if (face_stamp_[other] == stamp_) {
          pairs.emplace_back(faces[i], other);
        }
      }
    }
    return pairs;
  }

 private:
  std::vector<int32_t> neighbourhood(const Junction& junction) {
    ++stamp_;
    const LimbSurface& limb = surface_.limbs[junction.parent];
    std::vector<int32_t> vertices, faces;
    const auto reach = [&](int32_t v) {
      if (vertex_stamp_[v] != stamp_) {
        vertex_stamp_[v] = stamp_;
        vertices.push_back(v);
      }
    };
    for (int k = 0; k < 4; ++k) {
      reach(limb.rings[junction.row].vertices[k]);
      reach(limb.rings[junction.row + 1].vertices[k]);
      reach(surface_.limbs[junction.child].rings[0].vertices[k]);
    }
    size_t vertex = 0, face = 0;
    for (int step = 0; step < 3; ++step) {
      for (const size_t end = vertices.size(); vertex < end; ++vertex) {
        const int32_t v = vertices[vertex];
        for (int32_t i = around_.begin[v]; i < around_.begin[v + 1]; ++i) {
          const int32_t f = around_.faces[i];
          if (face_stamp_[f] != stamp_) {
            face_stamp_[f] = stamp_;
            faces.push_back(f);
          }
        }
      }
      for (; face < faces.size(); ++face) {
        for (int32_t v : surface_.quads[faces[face]]) {
          reach(v);
        }
      }
    }
    return faces;
  }

  bool touch(int32_t f, int32_t g) const {
    for (int32_t v : surface_.quads[f]) {
      for (int32_t w : surface_.quads[g]) {
        if (v == w) {
          return true;
        }
      }
    }
    return false;
  }

  /// Faces of a higher number that share a vertex with `f` and cross it. Junctions overlap, so the
  /// answer is kept: this is where nearly all the work would be repeated.
  const std::vector<int32_t>& crossing_neighbours(int32_t f) {
    if (neighbours_known_[f] == 0) {
      neighbours_known_[f] = 1;
      std::array<int32_t, 64> seen{};
      size_t seen_count = 0;
      for (int32_t v : surface_.quads[f]) {
        for (int32_t i = around_.begin[v]; i < around_.begin[v + 1]; ++i) {
          const int32_t g = around_.faces[i];
          if (g <= f ||
              std::find(seen.begin(), seen.begin() + seen_count, g) != seen.begin() + seen_count) {
            continue;
          }
          if (seen_count < seen.size()) {
            seen[seen_count++] = g;
          }
          if (quads_cross(f, g)) {
            crossing_neighbours_[f].push_back(g);
          }
        }
      }
    }
    const auto known = crossing_neighbours_.find(f);
    return known == crossing_neighbours_.end() ? none_ : known->second;
  }

  bool quads_cross(int32_t f, int32_t g) const {
    const Quad& p = surface_.quads[f];
    const Quad& q = surface_.quads[g];
    constexpr int kCorners[2][3] = {{0, 1, 2}, {0, 2, 3}};
    for (const auto& i : kCorners) {
      const Triangle a = {points_[p[i[0]]], points_[p[i[1]]], points_[p[i[2]]]};
      for (const auto& j : kCorners) {
        const Triangle b = {points_[q[j[0]]], points_[q[j[1]]], points_[q[j[2]]]};
        std::array<int, 3> shared = {-1, -1, -1};
        for (int k = 0; k < 3; ++k) {
          for (int l = 0; l < 3; ++l) {
            if (p[i[k]] == q[j[l]]) {
              shared[k] = l;
            }
          }
        }
        if (triangles_cross(a, b, shared)) {
          return true;
        }
      }
    }
    return false;
  }

  const Surface& surface_;
  VertexFaces around_;
  std::vector<int32_t> face_stamp_, vertex_stamp_;
  int32_t stamp_ = 0;
  std::vector<glm::dvec3> points_;
  std::vector<Box> boxes_;
  std::vector<uint8_t> neighbours_known_;
  std::map<int32_t, std::vector<int32_t>> crossing_neighbours_;
  const std::vector<int32_t> none_;
};

}  // namespace

JunctionCrossings find_crossings(const Surface& surface, const std::vector<uint8_t>& only) {
  CrossingFinder finder(surface);
  JunctionCrossings crossings(surface.junctions.size());
  for (size_t j = 0; j < crossings.size(); ++j) {
    if (only.empty() || only[j] != 0) {
      crossings[j] = finder.at(surface.junctions[j]);
    }
  }
  return crossings;
}

int32_t count_crossing(const JunctionCrossings& crossings) {
  return static_cast<int32_t>(std::count_if(crossings.begin(), crossings.end(),
                                            [](const auto& pairs) { return !pairs.empty(); }));
}

}  // namespace snowbough::tree
