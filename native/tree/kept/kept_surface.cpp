#include "tree/kept/kept_surface.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "tree/obj/polygons.h"
#include "tree/skeleton/centreline.h"
#include "tree/skeleton/segment_tree.h"

namespace snowbough::tree {
namespace {

/// Wood without a limb moves as one up to this number of polygons.
constexpr int32_t kSmallPart = 24;
/// Normals are wrong if more than this fraction of them is on the other side of their polygons.
constexpr double kMaxOpposed = 0.1;

/// The parts of the file that hold branches, ascending: piece p is the p-th.
std::vector<int32_t> parts_of_pieces(const std::vector<Branch>& branches) {
  std::vector<int32_t> parts;
  for (const Branch& branch : branches) parts.push_back(branch.piece);
  std::sort(parts.begin(), parts.end());
  parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
  return parts;
}

/// Per part: whether it is wood that the file has as a surface.
std::vector<char> wood_parts(const ClassifiedParts& classified) {
  std::vector<char> wood(classified.role.size(), 0);
  for (size_t p = 0; p < wood.size(); ++p) {
    if (classified.role[p] == PartRole::kCrossSection) {
      throw std::invalid_argument(
          "the file has planes across the limbs, which are no surface: import it without Keep "
          "Original Surface");
    }
    wood[p] =
        classified.role[p] == PartRole::kTube || classified.role[p] == PartRole::kWelded ? 1 : 0;
  }
  for (const SkippedPart& skipped : classified.skipped) wood[skipped.part] = skipped.wood ? 1 : 0;
  return wood;
}

glm::dvec3 area_vector(const KeptSurface& kept, size_t f) {
  const auto place = [&](int32_t c) { return glm::dvec3(kept.vertices[kept.corner_vertex[c]]); };
  glm::dvec3 sum(0.0);
  const int32_t begin = kept.face_begin[f];
  for (int32_t c = begin + 1; c + 1 < kept.face_begin[f + 1]; ++c) {
    sum += glm::cross(place(c) - place(begin), place(c + 1) - place(begin));
  }
  return sum;
}

/// Turns parts whose polygons face their limb's inside: some files have a quarter of their tubes
/// so.
void turn_outside_out(KeptSurface& kept) {
  std::map<int32_t, double> outward;
  for (size_t f = 0; f < kept.face_part.size(); ++f) {
    const int32_t v = kept.corner_vertex[kept.face_begin[f]];
    if (kept.vertex_piece[v] < 0) continue;
    const glm::dvec3 away = glm::dvec3(kept.vertices[v]) - glm::dvec3(kept.vertex_place[v]);
    outward[kept.face_part[f]] += glm::dot(area_vector(kept, f), away);
  }
  for (size_t f = 0; f < kept.face_part.size(); ++f) {
    const auto found = outward.find(kept.face_part[f]);
    if (found == outward.end() || found->second >= 0.0) continue;
    const auto turn = [&](auto& corners) {
      if (corners.empty()) return;
      std::reverse(corners.begin() + kept.face_begin[f], corners.begin() + kept.face_begin[f + 1]);
    };
    turn(kept.corner_vertex);
    turn(kept.corner_uv);
    turn(kept.corner_normal);
  }
}

/// Drops the normals if many are on the other side of their polygons. @return whether it did.
bool drop_wrong_normals(KeptSurface& kept) {
  size_t opposed = 0;
  for (size_t f = 0; !kept.corner_normal.empty() && f < kept.face_part.size(); ++f) {
    const glm::dvec3 flat = area_vector(kept, f);
    for (int32_t c = kept.face_begin[f]; c < kept.face_begin[f + 1]; ++c) {
      opposed += glm::dot(flat, glm::dvec3(kept.corner_normal[c])) < 0.0 ? 1 : 0;
    }
  }
  const bool wrong =
      static_cast<double>(opposed) > kMaxOpposed * static_cast<double>(kept.corner_vertex.size());
  if (wrong) kept.corner_normal = {};
  return wrong;
}

/// The branch nearest to the vertices of a part without a limb, and the place there.
void attach_part(const SegmentTree& segments, const std::vector<int32_t>& vertices,
                 int32_t polygons, KeptSurface& kept) {
  NearestSegment best;
  best.cost = std::numeric_limits<double>::infinity();
  for (const int32_t v : vertices) {
    const NearestSegment found = segments.nearest(kept.vertices[v], 1, Measure::kSurface);
    kept.vertex_branch[v] = found.branch;
    kept.vertex_place[v] = found.point;
    if (found.cost < best.cost) best = found;
  }
  if (polygons > kSmallPart) return;
  for (const int32_t v : vertices) {
    kept.vertex_branch[v] = best.branch;
    kept.vertex_place[v] = best.point;
  }
}

}  // namespace

KeptSurface gather_kept(const ObjScene& scene, const Parts& parts,
                        const ClassifiedParts& classified, const std::vector<Branch>& branches) {
  const std::vector<char> wood = wood_parts(classified);
  const std::vector<int32_t> pieces = parts_of_pieces(branches);
  KeptSurface kept;
  PolygonGatherer gatherer(scene, parts, kept);
  auto welded = classified.welded.begin();
  for (int32_t p = 0; p < parts.count(); ++p) {
    if (wood[p] == 0) continue;
    const size_t first = kept.vertices.size();
    gatherer.add(p, false);
    const size_t count = kept.vertices.size() - first;
    const auto piece = std::lower_bound(pieces.begin(), pieces.end(), p);
    const bool found = piece != pieces.end() && *piece == p;
    kept.vertex_piece.resize(kept.vertices.size(),
                             found ? static_cast<int32_t>(piece - pieces.begin()) : -1);
    while (welded != classified.welded.end() && welded->first < p) ++welded;
    if (welded != classified.welded.end() && welded->first == p) {
      const std::vector<int32_t>& limbs = welded->second.vertex_limb;
      kept.vertex_limb.insert(kept.vertex_limb.end(), limbs.begin(), limbs.end());
    }
    kept.vertex_limb.resize(first + count, 0);
    kept.face_part.resize(kept.face_material.size(), p);
  }
  kept.textured = std::any_of(scene.corner_uv.begin(), scene.corner_uv.end(),
                              [](int32_t uv) { return uv >= 0; });
  kept.flat = gatherer.finish();
  return kept;
}

void attach_kept(Skeleton& skeleton) {
  KeptSurface& kept = skeleton.kept;
  if (kept.vertices.empty()) return;
  std::map<std::pair<int32_t, int32_t>, int32_t> branch_of;
  for (size_t b = 0; b < skeleton.branches.size(); ++b) {
    const Branch& branch = skeleton.branches[b];
    branch_of[{branch.piece, branch.limb}] = static_cast<int32_t>(b);
  }
  kept.vertex_branch.assign(kept.vertices.size(), -1);
  kept.vertex_place.assign(kept.vertices.size(), glm::vec3(0.0f));
  // Wood without a limb, part by part: its vertices and the number of its polygons.
  std::map<int32_t, std::pair<std::vector<int32_t>, int32_t>> loose;
  for (size_t f = 0; f < kept.face_part.size(); ++f) {
    const int32_t begin = kept.face_begin[f];
    if (kept.vertex_piece[kept.corner_vertex[begin]] >= 0) continue;
    auto& [vertices, polygons] = loose[kept.face_part[f]];
    vertices.insert(vertices.end(), kept.corner_vertex.begin() + begin,
                    kept.corner_vertex.begin() + kept.face_begin[f + 1]);
    ++polygons;
  }
  for (size_t v = 0; v < kept.vertices.size(); ++v) {
    if (kept.vertex_piece[v] < 0) continue;
    const auto found = branch_of.find({kept.vertex_piece[v], kept.vertex_limb[v]});
    const int32_t branch = found != branch_of.end() ? found->second : 0;
    kept.vertex_branch[v] = branch;
    kept.vertex_place[v] = nearest_place(skeleton.branches[branch], kept.vertices[v]).point;
  }
  turn_outside_out(kept);
  if (drop_wrong_normals(kept)) {
    skeleton.report.warnings.emplace_back(
        "the normals of the file are on the wrong side of its polygons: the wood is shaded smooth "
        "instead");
  }
  if (loose.empty()) return;
  const SegmentTree segments(skeleton.branches, std::vector<int32_t>(skeleton.branches.size(), 0),
                             0.0f);
  for (auto& [part, found] : loose) attach_part(segments, found.first, found.second, kept);
}

}  // namespace snowbough::tree
