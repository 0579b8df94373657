#include "base/parallel_for.h"
#include "snow/step/cpu/kernel.h"
#include "snow/step/cpu/passes.h"

namespace snowbough::snow {
namespace kernel {
namespace {

#define WITH_OPACITY
#define WITH_SHADING
struct Gain {
#include "shaders/lib/texel_gain.h"
};

SNOWBOUGH_KERNEL void gather(Gain gain, size_t begin, size_t end, int32_t map_offset) {
  for (size_t i = begin; i < end; ++i) gain.gather_texel(static_cast<int>(i), map_offset);
}

}  // namespace
}  // namespace kernel

void cpu::gather_deposit(Scene& scene, const Tile& tile, bool is_first) {
  kernel::Gain gain{};
  gain.projection = scene.frame;
  gain.triangle_corners = scene.corners.data();
  gain.triangle_surface = scene.surface.data();
  if (scene.layout.smooth_points.count() > 0) {
    gain.triangle_points = scene.layout.smooth_points.of_triangle.data();
    gain.smooth_points = scene.smooth_points.data();
  }
  gain.triangle_sheets = kernel::words(scene.layout.triangle_sheets);
  gain.map_triangles = kernel::rows<glm::vec4>(scene.layout.map_triangles);
  gain.occlusion = kernel::rows<glm::uvec2>(scene.seen);
  gain.tile_origin = tile.with_margin().low;
  gain.tile_size = tile.with_margin().size();
  gain.goes_on = is_first ? 0 : 1;
  for (Receiver& receiver : scene.receivers) {
    gain.fragment_begin = kernel::words(receiver.fragment_begin);
    gain.fragments = kernel::rows<glm::uvec4>(receiver.fragments);
    gain.fragment_opacity = receiver.opacity.empty() ? nullptr : kernel::numbers(receiver.opacity);
    gain.texel_steps = kernel::rows<glm::uvec4>(receiver.steps);
    gain.resolution = static_cast<float>(receiver.resolution);
    base::for_each_item(receiver.active.size(), 4, [&](size_t i) {
      const size_t group = receiver.active[i];
      kernel::gather(gain, receiver.first_texel(group), receiver.first_texel(group + 1),
                     receiver.map_offset);
    });
  }
}

}  // namespace snowbough::snow
