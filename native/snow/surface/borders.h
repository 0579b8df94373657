#pragma once

#include <cstdint>
#include <vector>

#include "snow/surface/height_samples.h"
#include "snow/surface/surface_points.h"

namespace snowbough::snow {

/// Points near the border of the shown snow, where it ends away from rims.
struct Borders {
  std::vector<int32_t> point;
  /// Distance to the border in metres, to first order; negative outside the snow. Infinite where
  /// the border's direction is unknown.
  std::vector<float> distance;
  /// Height of the snow within a few points, in metres; not below 0.
  std::vector<float> crest;
  /// Share of the piece of snow that shows, 0 to 1: small pieces on walls do not.
  std::vector<float> part;
  /// Mean length of a point's edges, in metres.
  std::vector<float> edge;
};

/// Finds where the snow ends: a smooth line, since the line where the thickness passes the
/// threshold is as ragged as texels and noise. Pieces of snow and holes smaller than about half a
/// depth vanish.
/// @param sampled heights in the map at the points, before they were smoothed to `thickness`.
/// @param shown height of the shown snow by thickness alone, negative where none shows.
/// @param up upward components of the points' normals.
/// @param threshold thickness below which no snow shows, in metres.
/// @param front presence of a front at each point, 0 to 1. Snow does not end there.
/// @param depth depth on open ground at the end of the shot, in metres.
Borders find_borders(const SurfacePoints& points, const HeightSamples& samples,
                     const std::vector<float>& sampled, const std::vector<float>& thickness,
                     const std::vector<float>& threshold, const std::vector<float>& shown,
                     const std::vector<float>& up, const std::vector<float>& front, float depth);

/// Height of the shown snow near the border, with a round edge. It falls on beyond the border, so
/// that faces cross the receiver on the border and not beside it.
/// @param number index into the borders' points.
/// @param height height away from borders, positive.
/// @param sink depth of bare parts; `deepest`: their greatest depth at the border.
/// @param lobe noise, about -1 to 1, that moves the border.
float height_at_border(const Borders& borders, size_t number, float height, float sink,
                       float deepest, float lobe, float depth);

}  // namespace snowbough::snow
