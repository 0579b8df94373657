#include "tree/build_tree_mesh.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "base/parallel_for.h"
#include "tree/crossings/uncrossed_surface.h"
#include "tree/detail/refine.h"
#include "tree/mesh/bones.h"
#include "tree/mesh/limb_sections.h"
#include "tree/mesh/weights.h"
#include "tree/surface/crotch.h"
#include "tree/surface/limb_path.h"
#include "tree/surface/surface.h"
#include "tree/uv/bark_uvs.h"
#include "tree/uv/snow_uvs.h"

namespace snowbough::tree {
namespace {

/// Progress of the base at which its surface, and its charts, are finished.
constexpr float kSurfaceDone = 0.5f;
constexpr float kChartsDone = 0.9f;
/// Fraction of a detailed surface's time that the base takes.
constexpr float kBaseOfDetail = 0.3f;

void check_range(const char* name, int value, int low, int high) {
  if (value < low || value > high) {
    throw std::invalid_argument(std::string(name) + " must be from " + std::to_string(low) +
                                " to " + std::to_string(high) + ", not " + std::to_string(value));
  }
}

void check_options(const TreeMeshOptions& options) {
  check_range("snow_resolution", options.snow_resolution, 64, 16384);
  check_range("max_influences", options.max_influences, 1, 4);
  check_range("threads", options.threads, 0, 1024);
}

/// "a, b, c and 5 more"
std::string some_names(const Skeleton& skeleton, const std::vector<int32_t>& branches) {
  std::string text;
  const size_t shown = std::min<size_t>(branches.size(), 3);
  for (size_t i = 0; i < shown; ++i) {
    text += (i > 0 ? ", " : "") + skeleton.branches[branches[i]].name;
  }
  return branches.size() > shown
             ? text + " and " + std::to_string(branches.size() - shown) + " more"
             : text;
}

/// Warns about branches, listed as "a, b, c and 5 more"; no warning for an empty list.
void warn_of(const Skeleton& skeleton, const std::vector<int32_t>& branches, const char* what,
             TreeMesh& mesh) {
  if (branches.empty()) return;
  mesh.warnings.push_back(std::to_string(branches.size()) + " branches " + what + ": " +
                          some_names(skeleton, branches));
}

TreeMesh to_mesh(const Skeleton& skeleton, const UncrossedSurface& uncrossed) {
  const Surface& surface = uncrossed.surface;
  TreeMesh mesh;
  mesh.vertices.assign(surface.vertices.begin(), surface.vertices.end());
  mesh.quads = surface.quads;
  mesh.origins = surface.origins;
  mesh.branch_parents = surface.parents;
  for (const FaceOrigin& origin : surface.origins) {
    mesh.branch_level.push_back(skeleton.branches[origin.branch].level);
  }
  for (const LimbSurface& limb : surface.limbs) {
    mesh.continues_parent.push_back(limb.continues_parent ? 1 : 0);
    mesh.branch_rows.push_back(static_cast<int32_t>(limb.rings.size()) - 1);
  }
  warn_of(skeleton, surface.clamped,
          "are thicker than their parent where they leave it, and were narrowed there", mesh);
  warn_of(skeleton, surface.squeezed, "have a shortened base because their parent lacks room",
          mesh);
  warn_of(skeleton, uncrossed.narrowed, "were narrowed at their base to avoid others", mesh);
  warn_of(skeleton, uncrossed.crossing, "intersect others where they leave their parent", mesh);
  return mesh;
}

/// Calls both, in parallel if there are threads. `first` reports progress from the calling thread.
template <typename First, typename Second>
void do_both(int threads, const First& first, const Second& second) {
  if (threads == 1) {
    first();
    second();
  } else {
    base::parallel_for(2, [&](size_t part, size_t) { part == 0 ? first() : second(); });
  }
}

}  // namespace

TreeMesh build_tree_mesh(const Skeleton& skeleton, const TreeMeshOptions& options,
                         BuildReport* report) {
  check_options(options);
  const base::Execution whole{options.threads, options.progress};
  const float base_done = options.detail ? kBaseOfDetail : 1.0f;
  const base::Execution execution = whole.part(0.0f, base_done);
  base::report_progress(execution.progress, 0.0f);

  const LengthLimits scale = length_limits(skeleton);
  const Widths widths = limb_widths(skeleton, options.width);
  const std::vector<LimbPath> paths = limb_paths(skeleton, widths, scale);
  const std::vector<LimbPath> limbs = join_stems(skeleton, paths, scale);
  const UncrossedSurface uncrossed =
      build_uncrossed_surface(skeleton, limbs, scale, {options.close_root, options.close_tips},
                              execution.part(0.0f, kSurfaceDone));
  const Surface& surface = uncrossed.surface;

  TreeMesh mesh = to_mesh(skeleton, uncrossed);
  MeshCheck check;
  const auto unwrap = [&] {
    layout_snow_uvs(mesh, skeleton, options.snow_resolution,
                    execution.part(kSurfaceDone, kChartsDone));
  };
  const auto rig = [&] {
    // First, because it takes the most memory for itself.
    if (report != nullptr) check = check_mesh(mesh.vertices, mesh.quads);
    Armature armature = make_bones(skeleton, paths, scale, options.root_bone);
    VertexWeights weights = make_weights(surface, paths, armature, options.max_influences);
    mesh.bone_indices = std::move(weights.indices);
    mesh.bone_weights = std::move(weights.weights);
    mesh.bones = std::move(armature.bones);
    mesh.uv_bark = layout_bark_uvs(surface);
    if (!options.detail) mesh.sections = limb_sections(surface);
  };
  // Charts take as long as everything else that follows the surface.
  do_both(options.threads, unwrap, rig);
  base::report_progress(execution.progress, kChartsDone);

  if (options.detail) {
    mesh.base = std::make_shared<const TreeMesh>(mesh);
    refine(mesh, surface, limbs, scale, *options.detail, options.max_influences,
           whole.part(base_done, 1.0f));
  }
  base::report_progress(whole.progress, 1.0f);
  if (report != nullptr) {
    report->check = std::move(check);
    report->junctions = static_cast<int32_t>(surface.junctions.size());
    report->crossing_junctions = static_cast<int32_t>(uncrossed.crossing.size());
  }
  return mesh;
}

}  // namespace snowbough::tree
