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

SNOWBOUGH_KERNEL void evaluate(Surface surface, size_t begin, size_t end, TexelStep* steps) {
  for (size_t i = begin; i < end; ++i) {
    const Surface::TexelSurface texel =
        surface.surface_of(static_cast<int>(surface.fragment_begin[i].x),
                           static_cast<int>(surface.fragment_begin[i + 1].x));
    steps[i] = {0, texel.area, texel.up, texel.back_up};
  }
}

}  // namespace
}  // namespace kernel

void cpu::evaluate_texels(Scene& scene) {
  for (Receiver& receiver : scene.receivers) {
    kernel::Surface surface{};
    surface.triangle_surface = scene.surface.data();
    if (scene.layout.smooth_points.count() > 0) {
      surface.triangle_points = scene.layout.smooth_points.of_triangle.data();
      surface.smooth_points = scene.smooth_points.data();
    }
    surface.fragment_begin = kernel::words(receiver.fragment_begin);
    surface.fragments = kernel::rows<glm::uvec4>(receiver.fragments);
    base::for_each_item(receiver.active.size(), 4, [&](size_t i) {
      const size_t group = receiver.active[i];
      kernel::evaluate(surface, receiver.first_texel(group), receiver.first_texel(group + 1),
                       receiver.steps.data());
    });
  }
}

}  // namespace snowbough::snow
