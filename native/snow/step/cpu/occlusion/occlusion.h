#pragma once

#include <cstdint>
#include <span>

#include "base/thread_pool.h"
#include "shaders/lib/snow_shared.h"
#include "snow/scene/projection.h"
#include "snow/step/cpu/occlusion/occlusion_scene.h"
#include "snow/step/cpu/occlusion/triangle_bins.h"

namespace snowbough::snow::cpu {

/// Renders the scene along the fall onto one rectangle of the grid, on the processor: sorts the
/// triangles into bins of 64 x 64 pixels, then draws bin by bin on all cores.
///
/// Corners lie on steps of 1/256 pixel and their sides are evaluated in whole numbers, at pixels'
/// centres; a centre on a side belongs to the triangle at its right, on a level side to that above,
/// so that neighbours share none and leave none out. Nothing depends on the rectangle, the bins or
/// the number of threads: a part of a rectangle has the bits that the whole has there.
class OcclusionPass {
 public:
  struct Options {
    int32_t threads = base::default_threads();
    /// Triangles that are sorted at once, and their entries in bins: four bytes each.
    int64_t most_entries = int64_t{1} << 26;
  };

  OcclusionPass() = default;
  explicit OcclusionPass(const Options& options) : options_(options) {}

  /// Fills `seen`, row by row, with what the sky sees in each of `pixels` (local pixels of the
  /// grid): nearest in metres along the fall, of equally near ones that drawn first, whichever way
  /// it faces; back faces are marked. What an alpha mask cuts away is not there. A pixel that shows
  /// nothing is {0, kOpenSky}. One call at a time.
  /// @throws std::invalid_argument when `seen` has not as many elements as there are pixels, or the
  /// rectangle is wider than 16,320 pixels.
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
