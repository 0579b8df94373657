#include "tree/surface_crossings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "tree/surface_triangles.h"

namespace snowbough::tree {
namespace {

/// Junctions a thread looks at before it takes the next ones.
constexpr size_t kJunctionBlock = 256;
/// Distance from a plane, as a share of the coordinates that went into it, that rounding can not
/// make up.
constexpr double kClear = 1e-12;
/// Corners of the two triangles that a face counts as.
constexpr int kTriangles[2][3] = {{0, 1, 2}, {0, 2, 3}};

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

/// A face of a neighbourhood with all that the tests read of it.
struct Face {
  glm::dvec3 low, high;
  std::array<glm::dvec3, 4> points;
  /// Sum of the corners.
  glm::dvec3 sum;
  Quad corners;
  int32_t number;

  bool meets(const Face& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y &&
           other.low.y <= high.y && low.z <= other.high.z && other.low.z <= high.z;
  }
};

Face make_face(const Surface& surface, int32_t number) {
  Face face{};
  face.number = number;
  face.corners = surface.quads[number];
  for (int k = 0; k < 4; ++k) {
    face.points[k] = glm::dvec3(glm::vec3(surface.vertices[face.corners[k]]));
  }
  const auto& [a, b, c, d] = face.points;
  face.low = glm::min(glm::min(a, b), glm::min(c, d));
  face.high = glm::max(glm::max(a, b), glm::max(c, d));
  face.sum = a + b + c + d;
  return face;
}

/// Finds the faces near a junction. Each thread has its own: the stamps say what was met.
class Neighbourhoods {
 public:
  Neighbourhoods(const Surface& surface, const VertexFaces& around)
      : surface_(surface),
        around_(around),
        face_stamp_(surface.quads.size(), -1),
        vertex_stamp_(surface.vertices.size(), -1) {}

  /// The faces within two edges of the junction.
  const std::vector<int32_t>& at(const Junction& junction) {
    ++stamp_;
    vertices_.clear();
    faces_.clear();
    const auto reach = [&](int32_t v) {
      if (vertex_stamp_[v] != stamp_) {
        vertex_stamp_[v] = stamp_;
        vertices_.push_back(v);
      }
    };
    const LimbSurface& limb = surface_.limbs[junction.parent];
    for (int k = 0; k < 4; ++k) {
      reach(limb.rings[junction.row].vertices[k]);
      reach(limb.rings[junction.row + 1].vertices[k]);
      reach(surface_.limbs[junction.child].rings[0].vertices[k]);
    }
    size_t vertex = 0, face = 0;
    for (int step = 0; step < 3; ++step) {
      for (const size_t end = vertices_.size(); vertex < end; ++vertex) {
        const int32_t v = vertices_[vertex];
        for (int32_t i = around_.begin[v]; i < around_.begin[v + 1]; ++i) {
          const int32_t f = around_.faces[i];
          if (face_stamp_[f] != stamp_) {
            face_stamp_[f] = stamp_;
            faces_.push_back(f);
          }
        }
      }
      expanded_ = vertex;
      for (; face < faces_.size(); ++face) {
        for (int32_t v : surface_.quads[faces_[face]]) {
          reach(v);
        }
      }
    }
    return faces_;
  }

  /// After at(): the vertices whose faces were all taken.
  std::pair<const int32_t*, const int32_t*> expanded() const {
    return {vertices_.data(), vertices_.data() + expanded_};
  }

 private:
  const Surface& surface_;
  const VertexFaces& around_;
  std::vector<int32_t> face_stamp_, vertex_stamp_;
  int32_t stamp_ = 0;
  std::vector<int32_t> vertices_, faces_;
  size_t expanded_ = 0;
};

/// Neighbourhoods that no thread works with just now: as large as the surface, a block of junctions
/// should not have to make its own.
class NeighbourhoodPool {
 public:
  NeighbourhoodPool(const Surface& surface, const VertexFaces& around)
      : surface_(surface), around_(around) {}

  std::unique_ptr<Neighbourhoods> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        std::unique_ptr<Neighbourhoods> one = std::move(free_.back());
        free_.pop_back();
        return one;
      }
    }
    return std::make_unique<Neighbourhoods>(surface_, around_);
  }

  void give_back(std::unique_ptr<Neighbourhoods> one) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(one));
  }

 private:
  const Surface& surface_;
  const VertexFaces& around_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Neighbourhoods>> free_;
};

/// Whether a plane through what two faces share proves that they have nothing else in common: all
/// their other corners lie clear of it, on either side. The usual case; what it cannot tell is left
/// to the exact test.
bool parted(const Face& f, const Face& g) {
  std::array<bool, 4> of_f{}, of_g{};
  std::array<int, 4> shared{};
  int count = 0;
  for (int k = 0; k < 4; ++k) {
    for (int l = 0; l < 4; ++l) {
      if (f.corners[k] == g.corners[l]) {
        if (count == 2 || of_f[k] || of_g[l]) {
          return false;
        }
        of_f[k] = of_g[l] = true;
        shared[count++] = k;
      }
    }
  }
  const glm::dvec3& base = f.points[shared[0]];
  const glm::dvec3 extent = glm::max(f.high, g.high) - glm::min(f.low, g.low);
  double margin = kClear * (extent.x + extent.y + extent.z);
  glm::dvec3 normal = g.sum - f.sum;
  if (count == 0) {
    margin *= std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
  } else {
    // Half way between the directions in which the faces lie, however large either is.
    glm::dvec3 to_f = f.sum - 4.0 * base, to_g = g.sum - 4.0 * base;
    if (count == 2) {
      const glm::dvec3 edge = f.points[shared[1]] - base;
      const double squared = glm::dot(edge, edge);
      const double whole_f = glm::dot(to_f, to_f), whole_g = glm::dot(to_g, to_g);
      to_f -= edge * (glm::dot(to_f, edge) / squared);
      to_g -= edge * (glm::dot(to_g, edge) / squared);
      // What is left of a direction along the edge is rounding.
      if (!(glm::dot(to_f, to_f) > 1e-6 * whole_f && glm::dot(to_g, to_g) > 1e-6 * whole_g)) {
        return false;
      }
    }
    normal = glm::normalize(to_g) - glm::normalize(to_f);
  }
  double highest_f = -1e300, lowest_g = 1e300;
  for (int k = 0; k < 4; ++k) {
    if (!of_f[k]) {
      highest_f = std::max(highest_f, glm::dot(normal, f.points[k] - base));
    }
    if (!of_g[k]) {
      lowest_g = std::min(lowest_g, glm::dot(normal, g.points[k] - base));
    }
  }
  return count > 0 ? highest_f < -margin && lowest_g > margin : highest_f + margin < lowest_g;
}

/// Whether all corners of `g` but those that a triangle of `f` shares lie clear of its plane on one
/// side, for both triangles: decides most pairs of a large face and a small one.
bool on_one_side(const Face& f, const Face& g) {
  const glm::dvec3 size = f.high - f.low;
  const glm::dvec3 extent = glm::max(f.high, g.high) - glm::min(f.low, g.low);
  const double side = size.x + size.y + size.z;
  const double margin = kClear * side * side * (extent.x + extent.y + extent.z);
  for (const auto& corners : kTriangles) {
    const glm::dvec3& base = f.points[corners[0]];
    const glm::dvec3 normal = glm::cross(f.points[corners[1]] - base, f.points[corners[2]] - base);
    double lowest = 1e300, highest = -1e300;
    for (int k = 0; k < 4; ++k) {
      const int32_t v = g.corners[k];
      if (v != f.corners[corners[0]] && v != f.corners[corners[1]] && v != f.corners[corners[2]]) {
        const double height = glm::dot(normal, g.points[k] - base);
        lowest = std::min(lowest, height);
        highest = std::max(highest, height);
      }
    }
    if (!(lowest > margin || highest < -margin)) {
      return false;
    }
  }
  return true;
}

/// The exact test of all four pairs of triangles.
bool quads_cross(const Face& f, const Face& g) {
  for (const auto& i : kTriangles) {
    const Triangle a = {f.points[i[0]], f.points[i[1]], f.points[i[2]]};
    for (const auto& j : kTriangles) {
      const Triangle b = {g.points[j[0]], g.points[j[1]], g.points[j[2]]};
      std::array<int, 3> shared = {-1, -1, -1};
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) {
          if (f.corners[i[k]] == g.corners[j[l]]) {
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

/// All pairs among `faces` that cross, the lower number first, ascending.
std::vector<std::pair<int32_t, int32_t>> crossing_pairs(std::vector<Face>& faces) {
  glm::dvec3 low(1e300), high(-1e300);
  for (const Face& face : faces) {
    low = glm::min(low, face.low);
    high = glm::max(high, face.high);
  }
  const glm::dvec3 extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  std::vector<std::pair<double, const Face*>> order;
  order.reserve(faces.size());
  for (const Face& face : faces) {
    order.emplace_back(face.low[axis], &face);
  }
  std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.second->number < b.second->number;
  });
  // Swept along the longest axis: each face meets only those that begin before it ends.
  std::vector<std::pair<int32_t, int32_t>> pairs;
  for (size_t i = 0; i < order.size(); ++i) {
    const Face& one = *order[i].second;
    for (size_t j = i + 1; j < order.size() && order[j].first <= one.high[axis]; ++j) {
      const Face& other = *order[j].second;
      if (one.meets(other) && !parted(one, other) && !on_one_side(one, other) &&
          !on_one_side(other, one)) {
        const Face& f = one.number < other.number ? one : other;
        const Face& g = one.number < other.number ? other : one;
        if (quads_cross(f, g)) {
          pairs.emplace_back(f.number, g.number);
        }
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

JunctionCrossings find_crossings(const Surface& surface, const std::vector<uint8_t>& only,
                                 const Execution& execution) {
  const VertexFaces around(surface);
  JunctionCrossings crossings(surface.junctions.size());
  std::vector<size_t> wanted;
  for (size_t j = 0; j < crossings.size(); ++j) {
    if (only.empty() || only[j] != 0) {
      wanted.push_back(j);
    }
  }
  NeighbourhoodPool pool(surface, around);
  parallel_blocks(wanted.size(), kJunctionBlock, execution, [&](size_t begin, size_t end) {
    std::unique_ptr<Neighbourhoods> neighbourhoods = pool.take();
    std::vector<Face> faces;
    for (size_t i = begin; i < end; ++i) {
      faces.clear();
      for (const int32_t f : neighbourhoods->at(surface.junctions[wanted[i]])) {
        faces.push_back(make_face(surface, f));
      }
      crossings[wanted[i]] = crossing_pairs(faces);
    }
    pool.give_back(std::move(neighbourhoods));
  });
  return crossings;
}

std::vector<int32_t> missing_limbs(const Surface& surface, const std::vector<uint8_t>& only) {
  // A branch left out stands with its first ring alone.
  std::vector<uint8_t> open(surface.vertices.size(), 0);
  std::vector<std::pair<int32_t, int32_t>> rims;
  for (size_t b = 0; b < surface.limbs.size(); ++b) {
    if (surface.limbs[b].rings.size() == 1) {
      for (const int32_t v : surface.limbs[b].rings.front().vertices) {
        rims.emplace_back(v, static_cast<int32_t>(b));
        open[v] = 1;
      }
    }
  }
  std::sort(rims.begin(), rims.end());
  const VertexFaces around(surface);
  Neighbourhoods neighbourhoods(surface, around);
  std::vector<int32_t> missing;
  for (size_t j = 0; j < surface.junctions.size(); ++j) {
    if (!only.empty() && only[j] == 0) {
      continue;
    }
    neighbourhoods.at(surface.junctions[j]);
    const auto [from, to] = neighbourhoods.expanded();
    for (const int32_t* v = from; v != to; ++v) {
      if (open[*v] == 0) {
        continue;
      }
      for (auto rim = std::lower_bound(rims.begin(), rims.end(), std::pair(*v, 0));
           rim != rims.end() && rim->first == *v; ++rim) {
        missing.push_back(rim->second);
      }
    }
  }
  std::sort(missing.begin(), missing.end());
  missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
  return missing;
}

int32_t count_crossing(const JunctionCrossings& crossings) {
  return static_cast<int32_t>(std::count_if(crossings.begin(), crossings.end(),
                                            [](const auto& pairs) { return !pairs.empty(); }));
}

}  // namespace snowbough::tree
