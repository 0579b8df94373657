#include <algorithm>
#include <array>

#include "base/parallel_for.h"
#include "snow/step/cpu/kernel.h"
#include "snow/step/cpu/passes.h"

namespace snowbough::snow {
namespace kernel {
namespace {

#define WITH_SHADING
struct Surface {
#include "shaders/lib/texel_surface.h"
};

using Sums = std::array<Surface::SurfaceSums, kTexelGroup>;

/// Adds a run's fragments to their texels' sums.
inline void add_run(Surface& surface, const cpu::FragmentRuns& all, uint32_t begin, uint32_t end,
                    uint32_t triangle, Sums& sums) {
  const vec4 own = texelFetch(surface.triangle_surface, static_cast<int>(triangle));
  const bool two_sided = own.w != 0.0f;
  if (!surface.is_smooth(triangle)) {
    for (uint32_t f = begin; f < end; ++f) {
      Surface::SurfaceSums& texel = sums[all.texel[f]];
      texel = surface.with_fragment(texel, all.share[f] * own.y, own.z, two_sided);
    }
    return;
  }
  const Surface::SmoothTriangle points = surface.smooth_triangle(triangle);
  for (uint32_t f = begin; f < end; ++f) {
    Surface::SurfaceSums& texel = sums[all.texel[f]];
    const float up = surface.between(points.corner.z, points.edge_b.z, points.edge_c.z,
                                     all.weight_b[f], all.weight_c[f]);
    texel = surface.with_fragment(texel, all.share[f] * own.y, up, two_sided);
  }
}

/// Which part of its texel's area each of a run's fragments is.
inline void find_parts(const cpu::FragmentRuns& all, uint32_t begin, uint32_t end, float triangle,
                       const float* area, float* part) {
  const bool has_opacity = !all.opacity.empty();
  for (uint32_t f = begin; f < end; ++f) {
    const float own = all.share[f] * triangle * (has_opacity ? all.opacity[f] : 1.0f);
    part[f] = own > 0.0f ? own / area[all.texel[f]] : 0.0f;
  }
}

SNOWBOUGH_KERNEL void evaluate(Surface surface, cpu::FragmentRuns& all, size_t group,
                               size_t first_texel, size_t texel_count, cpu::TexelSteps& steps) {
  Sums sums;
  std::fill_n(sums.begin(), texel_count, Surface::SurfaceSums{});
  const cpu::FragmentRuns::Run* begin = all.runs.data() + all.group_begin[group];
  const cpu::FragmentRuns::Run* end = all.runs.data() + all.group_begin[group + 1];
  for (const cpu::FragmentRuns::Run* run = begin; run < end; ++run) {
    add_run(surface, all, run->begin, run[1].begin, run->triangle, sums);
  }
  std::array<float, kTexelGroup> area;
  for (size_t i = 0; i < texel_count; ++i) {
    const Surface::TexelSurface texel = surface.surface_of_sums(sums[i]);
    area[i] = texel.area;
    steps.area[first_texel + i] = texel.area;
    steps.up[first_texel + i] = texel.up;
    steps.back_up[first_texel + i] = texel.back_up;
  }
  for (const cpu::FragmentRuns::Run* run = begin; run < end; ++run) {
    find_parts(all, run->begin, run[1].begin, surface.triangle_surface[run->triangle].y,
               area.data(), all.part.data());
  }
}

}  // namespace
}  // namespace kernel

void cpu::evaluate_group(const Scene& scene, Receiver& receiver, size_t group) {
  if (receiver.evaluated_in[group] == receiver.pose) return;
  receiver.evaluated_in[group] = receiver.pose;
  kernel::Surface surface{};
  surface.triangle_surface = scene.surface.data();
  if (scene.layout.smooth_points.count() > 0) {
    surface.triangle_points = scene.layout.smooth_points.of_triangle.data();
    surface.smooth_points = scene.smooth_points.data();
  }
  const size_t first = receiver.first_texel(group);
  kernel::evaluate(surface, receiver.fragments, group, first,
                   receiver.first_texel(group + 1) - first, receiver.steps);
}

void cpu::evaluate_texels(Scene& scene) {
  for (Receiver& receiver : scene.receivers) {
    base::for_each_item(receiver.active.size(), 4, [&](size_t i) {
      const size_t group = receiver.active[i];
      evaluate_group(scene, receiver, group);
      std::fill(
          receiver.steps.gain.begin() + static_cast<ptrdiff_t>(receiver.first_texel(group)),
          receiver.steps.gain.begin() + static_cast<ptrdiff_t>(receiver.first_texel(group + 1)),
          0u);
    });
  }
}

}  // namespace snowbough::snow
