#include "snow/surface/snow_surface.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/parallel_for.h"
#include "snow/surface/borders.h"
#include "snow/surface/vertex_turns.h"

// Evaluates a frame. plan_surface.cpp computes the constants that it reads.

namespace snowbough::snow {
namespace {

using namespace shared;  // NOLINT(google-build-using-namespace): the shared rule's names

/// Rounds of smoothing of the heights, before and after thin snow is removed.
constexpr int kRoundsBefore = 5;
constexpr int kRoundsAfter = 2;
/// Volume of a front, as a fraction of the height behind it times the width of its zone.
constexpr float kUpright = 0.95f;
/// Height of a front at the rim, as a fraction of the height behind it.
constexpr float kDrawn = 0.94f;
/// Thickness behind a rim, as a fraction of the depth on open ground, from which on snow lies
/// there.
constexpr float kLiesBehind = 0.1f;
/// Greatest offset due to a curved receiver, as a fraction of the height.
constexpr float kMaxCurvature = 0.5f;

std::vector<glm::vec3> offsets(const SnowSurface& surface, const SnowStyle& style,
                               const SurfaceFrame& frame, const std::vector<float>& up,
                               const SurfaceHeightsNow& heights) {
  const SurfacePoints& points = surface.points;
  const PointLooks& looks = surface.looks;
  const Fronts& fronts = surface.fronts;
  std::vector<glm::vec3> offsets(points.count());
  for_point_blocks(offsets.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      const glm::vec3& normal = points.normal[p];
      const float shown = heights.shown[p];
      const SnowEdge edge =
          snow_edge(looks.point[p], heights.thickness[p], frame.open_depth, up[p]);
      glm::vec3 offset = normal * shown;
      const glm::vec3 down = normal * normal.z - glm::vec3(0.0f, 0.0f, 1.0f);
      const float slope = glm::length(down);
      if (slope > 1e-3f) {
        // Below the border, points move up as far: the border itself stays in place.
        const float sag =
            sagging(looks.point[p], style, edge, heights.thickness[p], std::abs(shown), up[p]);
        offset += down * (std::copysign(sag, shown) / slope);
      }
      if (shown > 0.0f) {
        const float bent = glm::length(points.curvature[p]);
        if (bent > 0.0f) {
          offset += points.curvature[p] * std::min(1.0f, kMaxCurvature * shown / bent);
        }
      }
      offsets[p] = offset;
    }
  });
  for_point_blocks(fronts.count(), [&](size_t, size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) {
      const auto p = static_cast<size_t>(fronts.point[f]);
      const SnowFront& front = fronts.front[f];
      const SnowBehind behind = fronts.behind(f, heights.shown, frame.open_depth);
      const SnowJoin join = snow_join(front, style, behind);
      const float presence = fronts.presence(f, behind, join);
      if (presence <= 0.0f) continue;
      // Up to the height off rims: the middle of a narrow top must not stand out.
      const float inwards = eased(front.distance, kFrontPart * front.zone, front.zone);
      const float part = glm::mix(kDrawn, 1.0f, std::max(join.joined, inwards));
      // The volume is kept here, not where the height comes from; but no front is higher than the
      // snow behind it.
      const float behind_it = std::max(fronts.inland[f].of(heights.factor), 1e-3f);
      const float kept = part * std::min(heights.factor[p] / behind_it, 1.0f);
      const glm::vec3 drawn = front_offset(
          front, style, {behind.inland * kept, behind.across * kept, behind.beyond * part}, join,
          points.normal[p], heights.shown[p], looks.point[p].bumps,
          std::min(kSink, looks.point[p].deepest));
      const glm::vec3 off_rims = offsets[p];
      offsets[p] = glm::mix(off_rims, drawn, presence);
      if (heights.blanket[f] <= 0.0f) continue;
      offsets[p] =
          glm::mix(offsets[p],
                   fronts.blanket_offset(f, join, heights.shown, off_rims, heights.blanket_up[f]),
                   heights.blanket[f]);
    }
  });
  bury_banks(fronts.banks, heights.thickness, heights.shown, up, frame.open_depth, offsets);
  even_out(surface.folds, points.normal, offsets);
  return offsets;
}

}  // namespace

SurfaceHeightsNow heights_now(const SnowSurface& surface, const SnowStyle& style,
                              const SurfaceFrame& frame, const std::vector<float>& up) {
  const SurfacePoints& points = surface.points;
  const HeightSamples& samples = surface.samples;
  const PointLooks& looks = surface.looks;
  const Fronts& fronts = surface.fronts;
  const size_t count = points.count();
  SurfaceHeightsNow heights;
  heights.thickness = sampled_heights(samples, frame.height);
  heights.blanket.resize(fronts.count());
  heights.blanket_up.assign(fronts.count(), glm::vec3(0.0f, 0.0f, 1.0f));
  // Where no snow lies, as below the piece above, none goes on: that must not end it beside.
  std::vector<glm::vec2> goes_on(fronts.count());
  base::for_each_item(fronts.count(), 1024, [&](size_t f) {
    const SnowBehind behind = fronts.behind(f, heights.thickness, frame.open_depth);
    const float lies = eased(behind.inland, 0.0f, kLiesBehind * frame.open_depth + 1e-6f);
    const float goes =
        fronts.goes_on(f, snow_join(fronts.front[f], style, behind), frame.open_depth);
    goes_on[f] = lies * glm::vec2(goes, 1.0f);
  });
  fronts.smooth(goes_on);
  for (size_t f = 0; f < fronts.count(); ++f) {
    heights.blanket[f] = goes_on[f].x / std::max(goes_on[f].y, 1e-6f);
  }
  const std::vector<float> sampled = heights.thickness;
  fronts.fill_hidden(heights.thickness);
  smooth(samples, heights.thickness, kRoundsBefore);
  const std::vector<float> held = heights.thickness;
  const std::vector<float> laid =
      fronts.blanket.lay(points, heights.blanket, heights.blanket_up, heights.thickness);
  heights.shown.resize(count);
  std::vector<float> threshold(count), sink(count);
  for_point_blocks(count, [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      const float thickness = heights.thickness[p];
      const SnowEdge edge = snow_edge(looks.point[p], thickness, frame.open_depth, up[p]);
      heights.shown[p] = thin_snow(edge, thickness);
      threshold[p] = edge.threshold;
      sink[p] = edge.sink;
    }
  });
  std::vector<float> front(count, 0.0f);
  base::for_each_item(fronts.count(), 1024, [&](size_t f) {
    const SnowBehind behind = fronts.behind(f, heights.thickness, frame.open_depth);
    front[fronts.point[f]] = fronts.presence(f, behind, snow_join(fronts.front[f], style, behind));
  });
  for (size_t p = 0; p < count; ++p) front[p] = std::max(front[p], laid[p]);
  const Borders borders = find_borders(points, samples, sampled, heights.thickness, threshold,
                                       heights.shown, up, front, frame.open_depth);
  base::for_each_item(borders.point.size(), 512, [&](size_t b) {
    const auto p = static_cast<size_t>(borders.point[b]);
    heights.shown[p] = height_at_border(
        borders, b, std::max(heights.shown[p], heights.thickness[p]), sink[p],
        looks.point[p].deepest, style.hem_variation * looks.point[p].hem, frame.open_depth);
  });
  const std::vector<float> rough = heights.shown;
  smooth(samples, heights.shown, kRoundsAfter);
  // A blanket is smooth, also where its mesh ends below another piece.
  for (size_t p = 0; p < count; ++p)
    heights.shown[p] = glm::mix(heights.shown[p], rough[p], laid[p]);
  const auto counted_area = [&](size_t p) {
    return fronts.counted.empty() ? samples.area[p] : samples.area[p] * fronts.counted[p];
  };
  std::vector<glm::vec2> volumes(count), laid_volumes(count);
  for_point_blocks(count, [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      if (heights.shown[p] > 0.0f) {
        heights.shown[p] +=
            surface_relief(looks.point[p], style, heights.shown[p], frame.open_depth);
      }
      const float in_map = counted_area(p) * held[p];
      const float now = glm::mix(in_map, counted_area(p) * heights.thickness[p], laid[p]);
      volumes[p] = {now, counted_area(p) * std::max(heights.shown[p], 0.0f)};
      laid_volumes[p] = {in_map, now};
    }
  });
  // Fronts add volume at the points near rims, because they are upright.
  base::for_each_item(fronts.count(), 1024, [&](size_t f) {
    const SnowFront& front = fronts.front[f];
    if (front.distance < 0.0f) return;
    const auto p = static_cast<size_t>(fronts.point[f]);
    const SnowBehind behind = fronts.behind(f, heights.shown, frame.open_depth);
    const SnowJoin join = snow_join(front, style, behind);
    // Snow that goes on beyond the rim holds what the map holds.
    const float height = behind.inland * glm::mix(kUpright, front.full, join.joined);
    const float more = height - std::max(heights.shown[p], 0.0f);
    volumes[p].y +=
        counted_area(p) * fronts.presence(f, behind, join) * more * (1.0f - heights.blanket[f]);
  });
  heights.factor = surface.volume.factors(volumes);
  // What a blanket fills comes from farther away: from beside, it would leave a furrow there.
  const std::vector<float> wide = surface.wide_volume.factors(laid_volumes);
  for (size_t p = 0; p < wide.size(); ++p) heights.factor[p] *= wide[p];
  for_point_blocks(count, [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      float& shown = heights.shown[p];
      if (shown <= 0.0f) continue;
      shown *= heights.factor[p];
      shown = glm::mix(swept_height(looks.point[p], shown), shown, laid[p]);
    }
  });
  return heights;
}

std::vector<glm::vec3> surface_points(const SnowSurface& surface, const SnowStyle& style,
                                      const SurfaceFrame& frame) {
  const SurfacePoints& points = surface.points;
  const size_t lying = points.count();
  std::vector<glm::vec3> carrier = points.mesh.position;
  std::vector<float> up(lying);
  std::vector<glm::quat> turn;
  if (frame.positions != nullptr) {
    const std::vector<glm::quat> turns =
        vertex_turns(surface.triangles, surface.positions, frame.positions);
    turn.resize(lying);
    for_point_blocks(lying, [&](size_t, size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p) {
        const int32_t* corner = &surface.triangles[static_cast<size_t>(points.triangle[p]) * 3];
        const glm::vec2 weight = points.weight[p];
        const glm::vec3 weights(1.0f - weight.x - weight.y, weight.x, weight.y);
        glm::quat sum(0.0f, 0.0f, 0.0f, 0.0f);
        carrier[p] = glm::vec3(0.0f);
        for (int k = 0; k < 3; ++k) {
          carrier[p] += weights[k] * frame.positions[corner[k]];
          const glm::quat& one = turns[corner[k]];
          sum = sum + one * (glm::dot(one, turns[corner[0]]) < 0.0f ? -weights[k] : weights[k]);
        }
        turn[p] = glm::normalize(sum);
      }
    });
  }
  for_point_blocks(lying, [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      up[p] = glm::dot(turn.empty() ? points.normal[p] : turn[p] * points.normal[p], frame.up);
    }
  });
  const SurfaceHeightsNow heights = heights_now(surface, style, frame, up);
  const std::vector<glm::vec3> offset = offsets(surface, style, frame, up, heights);
  const auto turned = [&](size_t p, const glm::vec3& vector) {
    return turn.empty() ? vector : turn[p] * vector;
  };
  std::vector<glm::vec3> result(surface.point_count());
  for_point_blocks(lying, [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) result[p] = carrier[p] + turned(p, offset[p]);
  });
  // Cushions grow in proportion to the snow at their anchors.
  const float bridging = std::clamp(style.bridging, 0.0f, 1.0f);
  for_point_blocks(surface.cushions.anchor.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) {
      const auto p = static_cast<size_t>(surface.cushions.anchor[c]);
      const float part = std::clamp(heights.thickness[p] / surface.cushions.height[c], 0.0f, 1.0f);
      result[lying + c] = result[p] + turned(p, surface.cushions.offset[c] * (bridging * part));
    }
  });
  for_point_blocks(result.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      result[p] = glm::vec3(frame.to_result * glm::vec4(result[p], 1.0f));
    }
  });
  return result;
}

std::vector<glm::vec3> point_normals(const std::vector<glm::vec3>& points,
                                     const std::vector<glm::ivec3>& triangles) {
  const auto count = static_cast<int32_t>(points.size());
  std::vector<glm::vec3> normals(points.size(), glm::vec3(0.0f));
  for (const glm::ivec3& t : triangles) {
    if (std::min({t.x, t.y, t.z}) < 0 || std::max({t.x, t.y, t.z}) >= count) {
      throw std::invalid_argument("each index in triangles must be a row of points");
    }
    const glm::vec3 cross = glm::cross(points[t.y] - points[t.x], points[t.z] - points[t.x]);
    for (int k = 0; k < 3; ++k) normals[t[k]] += cross;
  }
  for (glm::vec3& normal : normals) {
    const float length = glm::length(normal);
    normal = length > 0.0f ? normal / length : glm::vec3(0.0f, 0.0f, 1.0f);
  }
  return normals;
}

}  // namespace snowbough::snow
