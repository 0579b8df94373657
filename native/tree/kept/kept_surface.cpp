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
  if (loose.empty()) return;
  const SegmentTree segments(skeleton.branches, std::vector<int32_t>(skeleton.branches.size(), 0),
                             0.0f);
  for (auto& [part, found] : loose) attach_part(segments, found.first, found.second, kept);
}

}  // namespace snowbough::tree
