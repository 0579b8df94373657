#include "tree/surface/surface.h"

#include "tree/surface/builder.h"

namespace snowbough::tree {

Surface build_surface(const Skeleton& skeleton, const std::vector<LimbPath>& paths,
                      const SurfaceScale& scale, const SurfaceOptions& options,
                      const std::vector<uint8_t>& narrowing_steps,
                      const std::vector<uint8_t>& only) {
  SurfaceBuilder builder(skeleton, paths, scale, options, 1);
  builder.build(narrowing_steps);
  return builder.surface(only);
}

}  // namespace snowbough::tree
