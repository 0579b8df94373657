#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "snow/movement/moving_map.h"
#include "snow/movement/repose/ground.h"

namespace snowbough::snow {

/// Adds snow that lands on a map, each arrival spread over a disc.
class Splat {
 public:
  /// `radius`: of the disc, in metres. The texels must outlive this.
  Splat(const BareTexels& bare, const TexelTable& table, double radius);

  /// The texel at a place, -1: none.
  int32_t texel(int32_t place) const { return bare_.texel_of[static_cast<size_t>(place)]; }

  /// Moves a place to a lattice a quarter of the radius wide, so that neighbours land together.
  int32_t snapped(int32_t place) const;

  /// Spreads units (kLandingUnit) over the texels within the radius on the map and on the surface,
  /// in whole units; the remainder stays in the middle. Returns units that find no surface.
  int64_t add(int32_t place, int64_t units, MovingMap& map);

 private:
  float side_of(int32_t texel) const {
    return bare_.up[static_cast<size_t>(texel)] < 0.0f ? -1.0f : 1.0f;
  }
  bool holds(int32_t facing, int32_t at) const;
  int32_t broad_place_near(int32_t place) const;
  int32_t reach_at(int32_t place) const;
  std::pair<int32_t, int32_t> texels_between(int32_t first, int32_t last) const;
  float squared_distance(int32_t a, int32_t b) const;
  int64_t put(int32_t texel, int64_t units, MovingMap& map) const;

  const BareTexels& bare_;
  const std::vector<int32_t>& places_;
  int32_t side_;
  float radius_;
  /// The texels of a disc, and their weights.
  struct Part {
    int32_t texel = 0;
    double weight = 0.0;
  };
  std::vector<Part> parts_;
};

}  // namespace snowbough::snow
