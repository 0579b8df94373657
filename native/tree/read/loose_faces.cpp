#include "tree/read/loose_faces.h"

#include <algorithm>
#include <array>
#include <glm/vec3.hpp>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "base/union_find.h"
#include "tree/rings/rings.h"

namespace snowbough::tree {
namespace {

/// A part with more faces is not a single face or its halves.
constexpr size_t kMostFaces = 2;
/// A tube has at least three sides.
constexpr size_t kFewestWoodFaces = 3;

using Position = std::array<float, 3>;

/// An edge between two positions, the smaller one first, and its owners.
struct Edge {
  int32_t label;
  Position a, b;
  int32_t part;

  auto place() const { return std::tie(label, a, b); }
};

Position position_of(const ObjScene& scene, int32_t vertex) {
  const glm::vec3& p = scene.positions[vertex];
  // Adding zero merges both zeros.
  return {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
}

/// Whether a face is a line or a point, whose edges coincide.
bool is_line(const ObjScene& scene, int32_t f) {
  std::set<Position> corners;
  for (int32_t c = scene.face_begin[f]; c < scene.face_begin[f + 1]; ++c) {
    corners.insert(position_of(scene, scene.corner_vertex[c]));
  }
  return corners.size() < 3;
}

std::vector<Edge> sorted_edges(const ObjScene& scene, const Parts& parts,
                               const PartLabels& labels) {
  std::vector<Edge> edges;
  for (int32_t p = 0; p < parts.count(); ++p) {
    const std::span<const int32_t> faces = parts.part_faces(p);
    if (labels.meaning[p] == NameMeaning::kFoliage || faces.size() > kMostFaces) continue;
    for (const int32_t f : faces) {
      if (is_line(scene, f)) continue;
      const int32_t begin = scene.face_begin[f];
      const int32_t end = scene.face_begin[f + 1];
      for (int32_t c = begin; c < end; ++c) {
        const int32_t next = c + 1 < end ? c + 1 : begin;
        const Position a = position_of(scene, scene.corner_vertex[c]);
        const Position b = position_of(scene, scene.corner_vertex[next]);
        if (a != b) edges.push_back({labels.label[p], std::min(a, b), std::max(a, b), p});
      }
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) {
    return std::pair(e.place(), e.part) < std::pair(f.place(), f.part);
  });
  return edges;
}

/// Joins the two owners of every edge that has two.
base::UnionFind join_at_edges(const std::vector<Edge>& edges, int32_t part_count) {
  base::UnionFind sets(static_cast<size_t>(part_count));
  for (size_t i = 0; i < edges.size();) {
    size_t j = i + 1;
    while (j < edges.size() && edges[j].place() == edges[i].place()) ++j;
    if (j == i + 2) sets.join(edges[i].part, edges[i + 1].part);
    i = j;
  }
  return sets;
}

/// The faces or vertices of several parts, ascending.
template <typename OfPart>
std::vector<int32_t> gather(const std::vector<int32_t>& members, const OfPart& of_part) {
  std::vector<int32_t> all;
  for (const int32_t p : members) {
    const std::span<const int32_t> own = of_part(p);
    all.insert(all.end(), own.begin(), own.end());
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// The parts with every family as one part in the place of its first member.
Parts regroup(const Parts& parts, const std::vector<std::vector<int32_t>>& families) {
  Parts grouped;
  for (int32_t p = 0; p < parts.count(); ++p) {
    if (families[p].empty()) continue;
    const auto faces = gather(families[p], [&](int32_t q) { return parts.part_faces(q); });
    const auto vertices = gather(families[p], [&](int32_t q) { return parts.part_vertices(q); });
    grouped.faces.insert(grouped.faces.end(), faces.begin(), faces.end());
    grouped.vertices.insert(grouped.vertices.end(), vertices.begin(), vertices.end());
    grouped.face_begin.push_back(static_cast<int32_t>(grouped.faces.size()));
    grouped.vertex_begin.push_back(static_cast<int32_t>(grouped.vertices.size()));
    grouped.run.push_back(parts.run[p]);
  }
  return grouped;
}

/// Whether the combined parts are wood: a tube, or a forking surface.
bool are_wood(const ObjScene& scene, const Parts& parts, const std::vector<int32_t>& members) {
  const auto faces = gather(members, [&](int32_t q) { return parts.part_faces(q); });
  const auto vertices = gather(members, [&](int32_t q) { return parts.part_vertices(q); });
  NotATube why = NotATube::kNone;
  return trace_tube(scene, faces, vertices, why) || why == NotATube::kForks;
}

}  // namespace

Parts join_loose_faces(const ObjScene& scene, Parts parts, const PartLabels& labels,
                       const base::Progress& progress) {
  const std::vector<Edge> edges = sorted_edges(scene, parts, labels);
  base::report_progress(progress, 0.5f);
  base::UnionFind sets = join_at_edges(edges, parts.count());
  // Every family is stored at its first member.
  std::vector<std::vector<int32_t>> families(static_cast<size_t>(parts.count()));
  for (int32_t p = 0; p < parts.count(); ++p) families[sets.find(p)].push_back(p);
  bool joined = false;
  for (int32_t p = 0; p < parts.count(); ++p) {
    if ((p & 0xfff) == 0) {
      base::report_progress(
          progress, 0.5f + 0.5f * static_cast<float>(p) / static_cast<float>(parts.count()));
    }
    if (families[p].size() < 2) continue;
    if (families[p].size() >= kFewestWoodFaces && are_wood(scene, parts, families[p])) {
      joined = true;
      continue;
    }
    const std::vector<int32_t> members = std::move(families[p]);
    for (const int32_t q : members) families[q] = {q};
  }
  base::report_progress(progress, 1.0f);
  if (!joined) return parts;
  return regroup(parts, families);
}

}  // namespace snowbough::tree
