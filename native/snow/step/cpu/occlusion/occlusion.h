#pragma once

#include <cstdint>
#include <span>

#include "base/thread_pool.h"
#include "shaders/lib/snow_shared.h"
#include "snow/scene/projection.h"
#include "snow/step/cpu/occlusion/occlusion_scene.h"
#include "snow/step/cpu/occlusion/triangle_bins.h"

namespace snowbough::snow::cpu {

/// Renders the scene along the fall onto one rectangle of the grid, on the CPU: sorts the triangles
/// into bins of 64 x 64 pixels, then draws bin by bin on all cores.
///
/// Corners are snapped to 1/256 pixel and sides are evaluated in integers at pixel centres. A
/// centre on a side belongs to the triangle at its right, on a level side to the one above, so that
/// neighbours neither share a pixel nor leave a gap. The result does not depend on the rectangle,
/// the bins or the number of threads: a part of a rectangle has the bits of the whole.
class OcclusionPass {
 public:
  struct Options {
    int32_t threads = base::default_threads();
    /// Triangles that are sorted at once, and their bin entries: four bytes each.
    int64_t most_entries = int64_t{1} << 26;
  };

  OcclusionPass() = default;
  explicit OcclusionPass(const Options& options) : options_(options) {}

  /// Fills `seen`, row by row, with the surface that the sky sees in each of `pixels` (local pixels
  /// of the grid): the nearest in metres along the fall; of equally near ones, the first drawn,
  /// whichever side it shows. Back faces are marked; pixels that an alpha mask cuts away are open.
  /// A pixel that shows nothing is {0, kOpenSky}. One call at a time.
  /// @throws std::invalid_argument if `seen` has not one element per pixel, or the rectangle is
  /// wider than 16,320 pixels.
  void run(const OcclusionScene& scene, const PixelRect& pixels, std::span<shared::SeenPixel> seen);

 private:
  void draw(const OcclusionScene& scene, const DrawList& draws, int64_t first, int64_t end,
            const PixelRect& pixels, std::span<shared::SeenPixel> seen);
  void raster(const OcclusionScene& scene, const DrawList& draws, int64_t first,
              const PixelRect& pixels, std::span<shared::SeenPixel> seen);

  Options options_;
  TriangleBins bins_;
};

}  // namespace snowbough::snow::cpu
