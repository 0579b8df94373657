#include "snow/surface/height_samples.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "shaders/lib/snow_surface.h"
#include "snow/surface/map_sampler.h"

namespace snowbough::snow {
namespace {

/// A neighbour whose normal's upward component is lower by the first value counts fully, one that
/// is lower by the second does not count.
constexpr float kSameGround = 0.3f;
constexpr float kOnWall = 0.6f;
/// Factor on the weights of neighbours at sharp points.
constexpr float kSharpPart = 0.25f;

void find_samples(HeightSamples& samples, const SurfaceMesh& mesh, const SurfaceSource& source) {
  const size_t count = mesh.position.size();
  const std::vector<int32_t>& triangles = source.topology.triangles;
  struct Sample {
    int32_t point;
    glm::vec2 uv;
    float weight;
  };
  std::vector<Sample> corners;
  samples.area.assign(count, 0.0f);
  samples.side.assign(count, 1.0f);
  samples.up.assign(count, 0.0f);
  std::vector<float> sum_up(count, 0.0f);
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    const glm::vec3 cross = triangle_cross(mesh, t);
    const float area = 0.5f * glm::length(cross);
    // Where charts meet at an edge, the chart that faces the sky determines the height of the snow.
    const float level = std::clamp(area > 0.0f ? 0.5f * cross.z / area : 0.0f, 0.0f, 1.0f);
    const int32_t* corner = &triangles[static_cast<size_t>(mesh.base[t]) * 3];
    const glm::vec3 own = glm::cross(source.positions[corner[1]] - source.positions[corner[0]],
                                     source.positions[corner[2]] - source.positions[corner[0]]);
    const float side = glm::dot(own, cross) < 0.0f ? -1.0f : 1.0f;
    for (int k = 0; k < 3; ++k) {
      const int32_t p = mesh.triangle[t][k];
      samples.area[p] += area / 3.0f;
      samples.side[p] = side;
      const float weight = area * (0.02f + level * level);
      samples.up[p] += weight * mesh.normal[t][k].z;
      sum_up[p] += weight;
      corners.push_back({p, mesh.uv[t][k], weight});
    }
  }
  for (size_t p = 0; p < count; ++p) {
    if (sum_up[p] > 0.0f) samples.up[p] /= sum_up[p];
  }
  std::stable_sort(corners.begin(), corners.end(), [](const Sample& a, const Sample& b) {
    if (a.point != b.point) return a.point < b.point;
    return a.uv.x != b.uv.x ? a.uv.x < b.uv.x : a.uv.y < b.uv.y;
  });
  samples.begin.assign(count + 1, 0);
  for (size_t i = 0; i < corners.size();) {
    const auto p = static_cast<size_t>(corners[i].point);
    const auto first = samples.weight.size();
    float sum = 0.0f;
    for (; i < corners.size() && corners[i].point == static_cast<int32_t>(p); ++i) {
      const bool again =
          samples.weight.size() > first && i > 0 && corners[i].uv == corners[i - 1].uv;
      if (!again) {
        const MapSample place = map_sample(corners[i].uv, samples.resolution);
        samples.texel.push_back(place.texel);
        samples.share.push_back(place.share);
        samples.weight.push_back(0.0f);
      }
      samples.weight.back() += corners[i].weight;
      sum += corners[i].weight;
    }
    for (size_t s = first; s < samples.weight.size(); ++s) {
      samples.weight[s] = sum > 0.0f ? samples.weight[s] / sum
                                     : 1.0f / static_cast<float>(samples.weight.size() - first);
    }
    samples.begin[p + 1] = static_cast<int32_t>(samples.weight.size());
  }
}

void find_neighbours(HeightSamples& samples, const SurfaceMesh& mesh, float reach) {
  const size_t count = mesh.position.size();
  const SurfaceEdges edges = surface_edges(mesh.triangle);
  samples.neighbour_begin.assign(count + 1, 0);
  for (const auto& [a, b] : edges.ends) {
    ++samples.neighbour_begin[a + 1];
    ++samples.neighbour_begin[b + 1];
  }
  for (size_t p = 0; p < count; ++p) samples.neighbour_begin[p + 1] += samples.neighbour_begin[p];
  samples.neighbour.resize(edges.ends.size() * 2);
  samples.neighbour_weight.resize(samples.neighbour.size());
  std::vector<int32_t> next(samples.neighbour_begin.begin(), samples.neighbour_begin.end() - 1);
  for (const auto& [a, b] : edges.ends) {
    const glm::vec3 between = mesh.position[a] - mesh.position[b];
    const float weight = 0.5f * std::exp(-glm::dot(between, between) / (reach * reach));
    const float steeper = samples.up[a] - samples.up[b];
    samples.neighbour[next[a]] = b;
    samples.neighbour_weight[next[a]++] = weight * shared::eased(steeper, kOnWall, kSameGround);
    samples.neighbour[next[b]] = a;
    samples.neighbour_weight[next[b]++] = weight * shared::eased(-steeper, kOnWall, kSameGround);
  }
  samples.own_weight.resize(count);
  for (size_t p = 0; p < count; ++p) {
    const auto first = samples.neighbour_weight.begin() + samples.neighbour_begin[p];
    const auto last = samples.neighbour_weight.begin() + samples.neighbour_begin[p + 1];
    const float sum = std::accumulate(first, last, 1.0f);
    samples.own_weight[p] = 1.0f / sum;
    for (auto weight = first; weight != last; ++weight) *weight /= sum;
  }
}

}  // namespace

HeightSamples height_samples(const SurfaceMesh& mesh, const SurfaceSource& source, float reach) {
  HeightSamples samples;
  samples.resolution = source.topology.resolution;
  find_samples(samples, mesh, source);
  find_neighbours(samples, mesh, reach);
  return samples;
}

void sharpen(HeightSamples& samples, const std::vector<uint8_t>& is_sharp) {
  for (size_t p = 0; p < is_sharp.size(); ++p) {
    if (is_sharp[p] == 0) continue;
    for (int32_t i = samples.neighbour_begin[p]; i < samples.neighbour_begin[p + 1]; ++i) {
      samples.neighbour_weight[i] *= kSharpPart;
    }
    samples.own_weight[p] = 1.0f - kSharpPart * (1.0f - samples.own_weight[p]);
  }
}

std::vector<float> sampled_heights(const HeightSamples& samples, const float* map) {
  std::vector<float> heights(samples.count());
  for_point_blocks(heights.size(), [&](size_t, size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      float sum = 0.0f;
      for (int32_t i = samples.begin[p]; i < samples.begin[p + 1]; ++i) {
        sum += samples.weight[i] *
               map_value(map, samples.resolution, {samples.texel[i], samples.share[i]});
      }
      heights[p] = std::max(sum * samples.side[p], 0.0f);
    }
  });
  return heights;
}

void smooth(const HeightSamples& samples, std::vector<float>& values, int rounds) {
  std::vector<float> before(values.size());
  for (int round = 0; round < rounds; ++round) {
    before.swap(values);
    for_point_blocks(values.size(), [&](size_t, size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p) {
        float sum = samples.own_weight[p] * before[p];
        for (int32_t i = samples.neighbour_begin[p]; i < samples.neighbour_begin[p + 1]; ++i) {
          sum += samples.neighbour_weight[i] * before[samples.neighbour[i]];
        }
        values[p] = sum;
      }
    });
  }
}

}  // namespace snowbough::snow
