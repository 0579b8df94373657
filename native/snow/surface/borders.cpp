#include "snow/surface/borders.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "base/parallel_for.h"
#include "shaders/lib/snow_surface.h"

namespace snowbough::snow {
namespace {

/// Rings of points around each change from snow to no snow that belong to the border.
constexpr int kBorderRings = 8;
/// Rounds and reach, in depths, of the smoothing of the border.
constexpr int kBorderRounds = 8;
constexpr float kBorderReach = 0.25f;
/// Rounds in which the greatest height around a point spreads.
constexpr int kCrestRounds = 3;
/// Snow thinner than this fraction of the greatest height around it does not show: smoothing
/// spreads heights beyond the place where the snow ends.
constexpr float kOfCrest = 0.3f;
/// Such snow is there in the map if the map has more than the second of these fractions of its
/// thickness, and is not if less than the first; upward component of the normals of level ground.
constexpr float kSpread = 0.3f;
constexpr float kOwn = 0.8f;
constexpr float kOnLevelUp = 0.9f;
/// Snow thicker than this fraction of that height shows: noise bends the border and bites no holes.
constexpr float kMaxOfCrest = 0.6f;
/// Snow on steep places that is thinner than this fraction of the depth is left to the dusting of
/// the material.
constexpr float kVeil = 0.08f;
/// Pieces of snow with an area below the first number of square depths vanish from walls, those
/// above the second stay. Mean upward components of the normals on walls and on slopes.
constexpr float kSmallPiece = 0.15f;
constexpr float kPiece = 0.6f;
constexpr float kOnWallUp = 0.3f;
constexpr float kOnSlopeUp = 0.6f;
/// A neighbour on a face whose normal's upward component is lower by the first value does not say
/// where snow ends; one that is lower by the second does.
constexpr float kTurnsDownBy = 0.25f;
constexpr float kGoesOn = 0.08f;
/// Points with a greater presence of a front have its shape, not that of a border.
constexpr float kInFront = 0.9f;
/// Thinner snow, in metres, is none, also where there is no snow around that says so.
constexpr float kNothing = 1e-5f;
/// Distance from the border over which snow gets its height: in heights, and at most in depths.
constexpr float kRoundOff = 1.2f;
constexpr float kMaxRoundOff = 0.4f;
/// Greatest distance by which noise moves the border, in depths.
constexpr float kLobes = 0.15f;
/// Least change of the ratio per edge that says where the border lies.
constexpr float kMinChange = 0.02f;

/// 1 in snow much thicker than the threshold, 0 at the threshold, -1 on bare places.
float ratio_of(float thickness, float threshold) {
  return (thickness - threshold) / (thickness + threshold + 1e-9f);
}

/// The points within a few rings of a change of sign, in the order of their rings.
std::vector<int32_t> near_changes(const HeightSamples& samples, const std::vector<float>& ratio,
                                  const std::vector<float>& front, std::vector<int32_t>& number) {
  std::vector<uint8_t> changes(ratio.size(), 0);
  for_point_blocks(ratio.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      for (int32_t i = samples.neighbour_begin[p]; i < samples.neighbour_begin[p + 1]; ++i) {
        const bool other = ratio[samples.neighbour[i]] > 0.0f;
        if (samples.neighbour_weight[i] > 0.0f && other != (ratio[p] > 0.0f)) changes[p] = 1;
      }
    }
  });
  std::vector<int32_t> found;
  number.assign(ratio.size(), -1);
  const auto add = [&](size_t p) {
    if (number[p] >= 0 || front[p] >= kInFront) return;
    number[p] = static_cast<int32_t>(found.size());
    found.push_back(static_cast<int32_t>(p));
  };
  for (size_t p = 0; p < ratio.size(); ++p) {
    if (changes[p] != 0) add(p);
  }
  size_t begin = 0;
  for (int ring = 0; ring < kBorderRings; ++ring) {
    const size_t end = found.size();
    for (; begin < end; ++begin) {
      const int32_t p = found[begin];
      for (int32_t i = samples.neighbour_begin[p]; i < samples.neighbour_begin[p + 1]; ++i) {
        add(static_cast<size_t>(samples.neighbour[i]));
      }
    }
  }
  return found;
}

/// Share of each piece of snow near the border that shows: small pieces on walls are left to the
/// dusting of the material.
std::vector<float> shown_parts(const std::vector<int32_t>& near, const std::vector<int32_t>& number,
                               const HeightSamples& samples, const std::vector<float>& ratio,
                               const std::vector<float>& up, float depth) {
  std::vector<float> part(near.size(), 1.0f);
  std::vector<uint8_t> seen(near.size(), 0);
  std::vector<int32_t> piece;
  for (size_t first = 0; first < near.size(); ++first) {
    if (seen[first] != 0 || ratio[near[first]] <= 0.0f) continue;
    piece.assign(1, static_cast<int32_t>(first));
    seen[first] = 1;
    float area = 0.0f, level = 0.0f;
    bool goes_on = false;
    for (size_t k = 0; k < piece.size(); ++k) {
      const int32_t p = near[piece[k]];
      area += samples.area[p];
      level += samples.area[p] * up[p];
      for (int32_t i = samples.neighbour_begin[p]; i < samples.neighbour_begin[p + 1]; ++i) {
        const int32_t q = samples.neighbour[i];
        if (ratio[q] <= 0.0f) continue;
        const int32_t other = number[q];
        goes_on = goes_on || other < 0;
        if (other < 0 || seen[other] != 0) continue;
        seen[other] = 1;
        piece.push_back(other);
      }
    }
    if (goes_on) continue;
    const float large = shared::eased(area, kSmallPiece * depth * depth, kPiece * depth * depth);
    const float flat = shared::eased(level / std::max(area, 1e-12f), kOnWallUp, kOnSlopeUp);
    for (const int32_t b : piece) part[b] = std::max(large, flat);
  }
  return part;
}

}  // namespace

Borders find_borders(const SurfacePoints& points, const HeightSamples& samples,
                     const std::vector<float>& sampled, const std::vector<float>& thickness,
                     const std::vector<float>& threshold, const std::vector<float>& shown,
                     const std::vector<float>& up, const std::vector<float>& front, float depth) {
  Borders borders;
  std::vector<float> ratio(thickness.size());
  for_point_blocks(ratio.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) ratio[p] = ratio_of(thickness[p], threshold[p]);
  });
  std::vector<int32_t> number;
  borders.point = near_changes(samples, ratio, front, number);
  const size_t count = borders.point.size();
  std::vector<float> crest(ratio.size());
  for (const int32_t p : borders.point) {
    crest[p] = std::max(shown[p], 0.0f);
    for (int32_t i = samples.neighbour_begin[p]; i < samples.neighbour_begin[p + 1]; ++i) {
      const int32_t q = samples.neighbour[i];
      crest[q] = std::max(shown[q], 0.0f);
    }
  }
  // Each round reads all points and writes those near the border.
  const auto rounds = [&](int times, std::vector<float>& values, const auto& value_at) {
    std::vector<float> now(count);
    for (int round = 0; round < times; ++round) {
      base::for_each_item(
          count, 512, [&](size_t b) { now[b] = value_at(static_cast<size_t>(borders.point[b])); });
      for (size_t b = 0; b < count; ++b) values[borders.point[b]] = now[b];
    }
  };
  const std::vector<glm::vec3>& position = points.mesh.position;
  const float reach = kBorderReach * depth;
  const auto weight = [&](size_t p, int32_t i) {
    if (!(samples.neighbour_weight[i] > 0.0f)) return 0.0f;
    const glm::vec3 apart = position[p] - position[samples.neighbour[i]];
    const int32_t q = samples.neighbour[i];
    return (1.0f - front[q]) * shared::eased(samples.up[p] - samples.up[q], kTurnsDownBy, kGoesOn) *
           std::exp(-glm::dot(apart, apart) / (reach * reach));
  };
  const auto mean = [&](const std::vector<float>& values, size_t p) {
    float sum = values[p], total = 1.0f;
    for (int32_t i = samples.neighbour_begin[p]; i < samples.neighbour_begin[p + 1]; ++i) {
      const float share = weight(p, i);
      sum += share * values[samples.neighbour[i]];
      total += share;
    }
    return sum / total;
  };
  rounds(kCrestRounds, crest, [&](size_t p) {
    float most = crest[p];
    for (int32_t i = samples.neighbour_begin[p]; i < samples.neighbour_begin[p + 1]; ++i) {
      if (samples.neighbour_weight[i] > 0.0f) most = std::max(most, crest[samples.neighbour[i]]);
    }
    return most;
  });
  rounds(kCrestRounds, crest, [&](size_t p) { return mean(crest, p); });
  for (const int32_t p : borders.point) {
    // On level ground, what lies in the map at the point is not spread: the foot of a heap.
    const float spread =
        1.0f - shared::eased(sampled[p], kSpread * thickness[p], kOwn * thickness[p]) *
                   shared::eased(up[p], kOnSlopeUp, kOnLevelUp);
    const float noisy =
        std::clamp(threshold[p], kOfCrest * spread * crest[p], kMaxOfCrest * crest[p]);
    const float veil = kVeil * depth * shared::steepness(up[p]);
    ratio[p] = ratio_of(thickness[p], std::max({noisy, veil, kNothing}));
  }
  rounds(kBorderRounds, ratio, [&](size_t p) { return mean(ratio, p); });

  borders.part = shown_parts(borders.point, number, samples, ratio, up, depth);
  borders.distance.resize(count);
  borders.crest.resize(count);
  borders.edge.resize(count);
  base::for_each_item(count, 256, [&](size_t b) {
    const auto p = static_cast<size_t>(borders.point[b]);
    const glm::vec3& normal = points.normal[p];
    const glm::vec3 side = std::abs(normal.x) < 0.7f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    const glm::vec3 x = glm::normalize(glm::cross(normal, side));
    const glm::vec3 y = glm::cross(normal, x);
    // The plane through the ratios of the neighbours, by least squares.
    float xx = 0.0f, xy = 0.0f, yy = 0.0f, xr = 0.0f, yr = 0.0f, length = 0.0f, edges = 0.0f;
    for (int32_t i = samples.neighbour_begin[p]; i < samples.neighbour_begin[p + 1]; ++i) {
      const int32_t q = samples.neighbour[i];
      const glm::vec3 to = position[q] - position[p];
      const float squared = std::max(glm::dot(to, to), 1e-12f);
      length += std::sqrt(squared);
      edges += 1.0f;
      if (!(samples.neighbour_weight[i] > 0.0f)) continue;
      const float u = glm::dot(to, x), v = glm::dot(to, y), change = ratio[q] - ratio[p];
      xx += u * u / squared;
      xy += u * v / squared;
      yy += v * v / squared;
      xr += u * change / squared;
      yr += v * change / squared;
    }
    const float edge = edges > 0.0f ? length / edges : depth;
    const float both = xx * yy - xy * xy;
    const float slope =
        both > 1e-4f ? std::hypot(yy * xr - xy * yr, xx * yr - xy * xr) / both : 0.0f;
    borders.edge[b] = edge;
    borders.crest[b] = crest[p];
    borders.distance[b] = slope * edge > kMinChange
                              ? ratio[p] / slope
                              : std::copysign(std::numeric_limits<float>::infinity(), ratio[p]);
  });
  return borders;
}

float height_at_border(const Borders& borders, size_t number, float height, float sink,
                       float deepest, float lobe, float depth) {
  const float distance = borders.distance[number] + kLobes * depth * lobe;
  const float shown = borders.part[number];
  const float crest = borders.crest[number] * shown;
  const float way =
      std::max(std::min(kRoundOff * crest, kMaxRoundOff * depth), borders.edge[number]);
  const float part = std::min(std::abs(distance) / way, 1.0f);
  const float rise = part * (2.0f - part);
  if (distance > 0.0f) return glm::mix(-sink, rise * glm::mix(crest, height, part), shown);
  return -rise * std::max(std::min(crest, deepest), sink);
}

}  // namespace snowbough::snow
