#include "tree/detail/refine.h"

#include <algorithm>
#include <utility>

#include "tree/collars/fork_field.h"
#include "tree/collars/places.h"
#include "tree/detail/clear_limbs.h"
#include "tree/detail/forks.h"
#include "tree/mesh/edges.h"
#include "tree/mesh/weights.h"
#include "tree/tubes/cuts.h"
#include "tree/tubes/fine_mesh.h"
#include "tree/tubes/limb_shape.h"
#include "tree/tubes/limb_tubes.h"

namespace snowbough::tree {
namespace {

/// Vertices or faces per thread at a time.
constexpr size_t kBlock = 4096;
/// Progress at which the mesh is cut, its forks are blended, intersections are repaired, and
/// weights are set.
constexpr float kCutDone = 0.3f;
constexpr float kForksDone = 0.7f;
constexpr float kCleared = 0.85f;
constexpr float kWeighted = 0.93f;

/// Bilinear weights of a quad's four corners.
std::array<double, 4> corner_shares(double u, double v) {
  return {(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v};
}

glm::vec2 uv_at(const QuadUv& uv, const glm::dvec2& place) {
  const std::array<double, 4> shares = corner_shares(place.x, place.y);
  glm::dvec2 sum(0.0);
  for (int k = 0; k < 4; ++k) {
    sum += glm::dvec2(uv[k]) * shares[k];
  }
  return glm::vec2(sum);
}

void interpolate_weights(const FineMesh& fine, int max_influences, TreeMesh& mesh,
                         const base::Execution& execution) {
  const size_t base_count = mesh.vertices.size();
  mesh.bone_indices.resize(fine.vertices.size());
  mesh.bone_weights.resize(fine.vertices.size());
  base::parallel_for(fine.vertices.size() - base_count, kBlock, execution,
                     [&](size_t begin, size_t end) {
                       for (size_t v = base_count + begin; v < base_count + end; ++v) {
                         const FinePlace& place = fine.vertices[v];
                         const Quad& quad = mesh.quads[place.face];
                         const std::array<double, 4> shares = corner_shares(place.u, place.v);
                         InfluenceSum sum;
                         for (int k = 0; k < 4; ++k) {
                           for (int i = 0; i < 4 && shares[k] > 0.0; ++i) {
                             const float weight = mesh.bone_weights[quad[k]][i];
                             if (weight > 0.0f)
                               sum.add(mesh.bone_indices[quad[k]][i], shares[k] * weight);
                           }
                         }
                         sum.finish(max_influences, mesh.bone_indices[v], mesh.bone_weights[v]);
                       }
                     });
}

void take_faces(FineMesh fine, TreeMesh& mesh, const base::Execution& execution) {
  const size_t count = fine.quads.size();
  std::vector<FaceOrigin> origins(count);
  std::vector<int32_t> levels(count);
  std::vector<QuadUv> uv_bark(count), uv_snow(mesh.uv_snow.empty() ? 0 : count);
  base::parallel_for(count, kBlock, execution, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) {
      const int32_t base = fine.face[f];
      origins[f] = mesh.origins[base];
      levels[f] = mesh.branch_level[base];
      for (int k = 0; k < 4; ++k) {
        uv_bark[f][k] = uv_at(mesh.uv_bark[base], fine.corners[f][k]);
        if (!uv_snow.empty()) uv_snow[f][k] = uv_at(mesh.uv_snow[base], fine.corners[f][k]);
      }
    }
  });
  mesh.quads = std::move(fine.quads);
  mesh.origins = std::move(origins);
  mesh.branch_level = std::move(levels);
  mesh.uv_bark = std::move(uv_bark);
  mesh.uv_snow = std::move(uv_snow);
}

}  // namespace

void refine(TreeMesh& mesh, const Surface& surface, const std::vector<LimbPath>& paths,
            const LengthLimits& scale, Detail detail, int max_influences,
            const base::Execution& execution) {
  const std::vector<int32_t>& parents = surface.parents;
  const Edges edges(mesh.quads, mesh.vertices.size());
  const DetailSettings settings = detail_settings(detail);
  const std::vector<LimbShape> shapes =
      limb_shapes(surface, paths, parents, settings.thin_stray * scale.height);
  const BaseCuts cuts = cut_base(surface, edges, shapes, scale.height, settings);
  FineMesh fine = cut_quads(mesh.quads, mesh.vertices.size(), edges, cuts);
  const std::vector<int32_t> chains = limb_chains(surface, parents);
  const LimbTubes tubes(surface, shapes, cuts, chains);
  base::report_progress(execution.progress, kCutDone);
  const std::vector<Fork> forks = collect_forks(surface, tubes);
  std::vector<glm::dvec3> points = limb_positions(surface, tubes, forks, fine, execution.threads);
  blend_forks(surface, forks, chains, fine, execution.part(kCutDone, kForksDone), points);
  clear_limbs(surface, paths, parents, chains, fine, execution.part(kForksDone, kCleared), points);
  interpolate_weights(fine, max_influences, mesh, execution.part(kCleared, kWeighted));
  take_faces(std::move(fine), mesh, execution.part(kWeighted, 1.0f));
  mesh.vertices.assign(points.begin(), points.end());
}

}  // namespace snowbough::tree
