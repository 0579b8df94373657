#include "tree/mesh/lod.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <span>
#include <utility>

#include "tree/mesh/edges.h"
#include "tree/mesh/limb_sections.h"
#include "tree/mesh/weights.h"

namespace snowbough::tree {
namespace {

/// Displacement of a vertex on the rim of a child's hole towards its neighbours, relative to the
/// nearest one's distance.
constexpr double kRimSmoothing = 0.4;
/// Edges or faces per thread at a time.
constexpr size_t kBlock = 4096;

/// All sections, limb by limb, and each branch's first.
struct Sections {
  std::vector<LimbSection> all;
  std::vector<int32_t> first;

  explicit Sections(const Surface& surface) : all(limb_sections(surface)) {
    int32_t next = 0;
    for (const LimbSurface& limb : surface.limbs) {
      first.push_back(next);
      next += static_cast<int32_t>(limb.rings.size()) - 1;
    }
  }

  /// -1 for caps, which stay flat.
  int32_t of(const FaceOrigin& origin) const {
    const bool cap = origin.part == FacePart::kTipCap || origin.part == FacePart::kRootCap;
    return cap ? -1 : first[origin.branch] + origin.row;
  }
};

/// The distinct sections around a vertex.
struct SectionSet {
  std::array<int32_t, 8> members{};
  int count = 0;

  void add(int32_t section) {
    const auto end = members.begin() + count;
    if (section >= 0 && count < static_cast<int>(members.size()) &&
        std::find(members.begin(), end, section) == end) {
      members[count++] = section;
    }
  }
  glm::dvec3 rounded(const Sections& sections, const glm::dvec3& p) const {
    if (count == 0) {
      return p;
    }
    glm::dvec3 sum(0.0);
    for (int i = 0; i < count; ++i) {
      sum += on_limb(sections.all[members[i]], p);
    }
    return sum / static_cast<double>(count);
  }
  bool joins_limbs(const Sections& sections) const {
    for (int i = 1; i < count; ++i) {
      if (sections.all[members[i]].limb != sections.all[members[0]].limb) {
        return true;
      }
    }
    return false;
  }
};

class Subdivider {
 public:
  Subdivider(TreeMesh& mesh, const Surface& surface, int max_influences)
      : mesh_(mesh),
        sections_(surface),
        max_influences_(max_influences),
        points_(surface.vertices),
        rim_(surface.vertices.size(), 0) {}

  /// Projects the base's corners, which are outside the limbs' round radius, onto it.
  void round_base() {
    std::vector<SectionSet> around(points_.size());
    std::vector<int32_t> inset(points_.size(), -1);
    for (size_t f = 0; f < mesh_.quads.size(); ++f) {
      const int32_t section = sections_.of(mesh_.origins[f]);
      for (int32_t v : mesh_.quads[f]) {
        around[v].add(section);
      }
      if (mesh_.origins[f].part == FacePart::kInset) {
        inset[mesh_.quads[f][2]] = inset[mesh_.quads[f][3]] = section;
      }
    }
    for (size_t v = 0; v < points_.size(); ++v) {
      points_[v] = inset[v] >= 0 ? on_limb(sections_.all[inset[v]], points_[v])
                                 : around[v].rounded(sections_, points_[v]);
      rim_[v] = around[v].joins_limbs(sections_) ? 1 : 0;
    }
  }

  void split(const base::Execution& execution) {
    const Edges edges(mesh_.quads, points_.size());
    const auto old_count = static_cast<int32_t>(points_.size());
    const auto edge_count = static_cast<int32_t>(edges.all.size());
    const size_t face_count = mesh_.quads.size();
    points_.resize(old_count + edge_count + face_count);
    rim_.resize(points_.size(), 0);
    mesh_.bone_indices.resize(points_.size());
    mesh_.bone_weights.resize(points_.size());
    // Every new vertex depends only on older ones, a face's also on its edges'.
    base::parallel_for(edges.all.size(), kBlock, execution.part(0.0f, 0.4f),
                       [&](size_t begin, size_t end) {
                         for (size_t e = begin; e < end; ++e) {
                           split_edge(edges.all[e], old_count + static_cast<int32_t>(e));
                         }
                       });
    base::parallel_for(
        face_count, kBlock, execution.part(0.4f, 0.7f), [&](size_t begin, size_t end) {
          for (size_t f = begin; f < end; ++f) {
            place_centre(f, edges, old_count, old_count + edge_count + static_cast<int32_t>(f));
          }
        });
    split_faces(edges, old_count, edge_count, execution.part(0.7f, 1.0f));
    smooth_rims();
  }

  void finish() { mesh_.vertices.assign(points_.begin(), points_.end()); }

 private:
  /// Places vertex v in the middle of an edge.
  void split_edge(const Edges::Edge& edge, int32_t v) {
    const glm::dvec3 middle = 0.5 * (points_[edge.a] + points_[edge.b]);
    const FaceOrigin& left = mesh_.origins[edge.left];
    const FaceOrigin& right = mesh_.origins[edge.right >= 0 ? edge.right : edge.left];
    SectionSet around;
    around.add(sections_.of(left));
    around.add(sections_.of(right));
    rim_[v] = around.joins_limbs(sections_) ? 1 : 0;
    const bool inset = left.part == FacePart::kInset || right.part == FacePart::kInset;
    if (inset && left.branch != right.branch) {
      const int32_t parent = sections_.of(left.part == FacePart::kInset ? left : right);
      points_[v] = on_limb(sections_.all[parent], middle);
    } else {
      points_[v] = around.rounded(sections_, middle);
    }
    const std::array<int32_t, 2> ends = {edge.a, edge.b};
    mean_weights(v, ends);
  }

  /// Places vertex v in the middle of face f, whose edges' vertices start at `first_edge`.
  void place_centre(size_t f, const Edges& edges, int32_t first_edge, int32_t v) {
    SectionSet around;
    around.add(sections_.of(mesh_.origins[f]));
    // The mean of the edge points, which are on the limb's radius already, is closer to it than the
    // corners' mean.
    glm::dvec3 middle(0.0);
    for (int k = 0; k < 4; ++k) {
      middle += 0.25 * points_[first_edge + edges.of_face[f][k]];
    }
    points_[v] = around.rounded(sections_, middle);
    mean_weights(v, mesh_.quads[f]);
  }

  void mean_weights(int32_t vertex, std::span<const int32_t> from) {
    const auto same = [&](int32_t v) {
      return mesh_.bone_indices[v] == mesh_.bone_indices[from[0]] &&
             mesh_.bone_weights[v] == mesh_.bone_weights[from[0]];
    };
    if (std::all_of(from.begin() + 1, from.end(), same)) {
      mesh_.bone_indices[vertex] = mesh_.bone_indices[from[0]];
      mesh_.bone_weights[vertex] = mesh_.bone_weights[from[0]];
      return;
    }
    InfluenceSum sum;
    for (const int32_t v : from) {
      for (int k = 0; k < 4; ++k) {
        const float weight = mesh_.bone_weights[v][k];
        if (weight > 0.0f) {
          sum.add(mesh_.bone_indices[v][k], weight);
        }
      }
    }
    sum.finish(max_influences_, mesh_.bone_indices[vertex], mesh_.bone_weights[vertex]);
  }

  static void split_uv(const QuadUv& uv, QuadUv* parts) {
    const glm::vec2 centre = 0.25f * (uv[0] + uv[1] + uv[2] + uv[3]);
    for (int k = 0; k < 4; ++k) {
      parts[k][k] = uv[k];
      parts[k][(k + 1) % 4] = 0.5f * (uv[k] + uv[(k + 1) % 4]);
      parts[k][(k + 2) % 4] = centre;
      parts[k][(k + 3) % 4] = 0.5f * (uv[k] + uv[(k + 3) % 4]);
    }
  }

  void split_faces(const Edges& edges, int32_t old_count, int32_t edge_count,
                   const base::Execution& execution) {
    const size_t face_count = mesh_.quads.size();
    std::vector<Quad> quads(face_count * 4);
    std::vector<FaceOrigin> origins(face_count * 4);
    std::vector<int32_t> levels(face_count * 4);
    std::vector<QuadUv> uv_bark(face_count * 4);
    std::vector<QuadUv> uv_snow(mesh_.uv_snow.empty() ? 0 : face_count * 4);
    base::parallel_for(face_count, kBlock, execution, [&](size_t begin, size_t end) {
      for (size_t f = begin; f < end; ++f) {
        const int32_t centre = old_count + edge_count + static_cast<int32_t>(f);
        for (int k = 0; k < 4; ++k) {
          Quad& part = quads[4 * f + k];
          part[k] = mesh_.quads[f][k];
          part[(k + 1) % 4] = old_count + edges.of_face[f][k];
          part[(k + 2) % 4] = centre;
          part[(k + 3) % 4] = old_count + edges.of_face[f][(k + 3) % 4];
          origins[4 * f + k] = mesh_.origins[f];
          levels[4 * f + k] = mesh_.branch_level[f];
        }
        split_uv(mesh_.uv_bark[f], &uv_bark[4 * f]);
        if (!uv_snow.empty()) {
          split_uv(mesh_.uv_snow[f], &uv_snow[4 * f]);
        }
      }
    });
    mesh_.quads = std::move(quads);
    mesh_.origins = std::move(origins);
    mesh_.branch_level = std::move(levels);
    mesh_.uv_bark = std::move(uv_bark);
    mesh_.uv_snow = std::move(uv_snow);
  }

  /// Moves every rim vertex along the mean direction to its neighbours, by a fraction of the
  /// distance to the nearest one: the first row of a long branch must not pull its rim out of the
  /// parent.
  void smooth_rims() {
    struct Around {
      glm::dvec3 sum{0.0};
      double nearest = std::numeric_limits<double>::max();
      int32_t count = 0;
    };
    // Rim vertices are few: only they get a list.
    std::vector<int32_t> rim_vertices;
    std::vector<int32_t> place(points_.size(), -1);
    for (size_t v = 0; v < points_.size(); ++v) {
      if (rim_[v] != 0) {
        place[v] = static_cast<int32_t>(rim_vertices.size());
        rim_vertices.push_back(static_cast<int32_t>(v));
      }
    }
    std::vector<Around> rim(rim_vertices.size());
    for (const Quad& quad : mesh_.quads) {
      for (int k = 0; k < 4; ++k) {
        // Every edge appears in both its faces, once in either direction.
        const int32_t v = quad[k];
        if (place[v] >= 0) {
          Around& around = rim[place[v]];
          const glm::dvec3 offset = points_[quad[(k + 1) % 4]] - points_[v];
          const double length = std::max(glm::length(offset), 1e-30);
          around.sum += offset / length;
          around.nearest = std::min(around.nearest, length);
          ++around.count;
        }
      }
    }
    for (size_t i = 0; i < rim.size(); ++i) {
      if (rim[i].count > 0) {
        points_[rim_vertices[i]] +=
            rim[i].sum * (kRimSmoothing * rim[i].nearest / static_cast<double>(rim[i].count));
      }
    }
  }

  TreeMesh& mesh_;
  Sections sections_;
  int max_influences_;
  std::vector<glm::dvec3> points_;
  /// 1 for vertices on the rim of a child's hole.
  std::vector<uint8_t> rim_;
};

}  // namespace

void subdivide(TreeMesh& mesh, const Surface& surface, int levels, int max_influences,
               const base::Execution& execution) {
  if (levels <= 0) {
    return;
  }
  Subdivider subdivider(mesh, surface, max_influences);
  subdivider.round_base();
  // Each level takes four times as long as the one before.
  float done = 0.0f;
  for (int level = 0; level < levels; ++level) {
    const float share = 0.75f * std::pow(0.25f, static_cast<float>(levels - 1 - level));
    const float after = level + 1 < levels ? done + share : 1.0f;
    subdivider.split(execution.part(done, after));
    done = after;
  }
  subdivider.finish();
}

}  // namespace snowbough::tree
