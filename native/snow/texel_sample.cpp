#include <algorithm>

#include "snow/texel_draft.h"

namespace snowbough::snow {
namespace {

double cross(glm::dvec2 a, glm::dvec2 b) {
  return a.x * b.y - a.y * b.x;
}

struct TexelSample {
  int32_t triangle;
  glm::vec2 barycentric;
  float coverage;
};

/// Weights of the second and third corner.
glm::dvec2 barycentric_at(const MapTopology& topology, int32_t triangle, glm::dvec2 point) {
  const UvTriangle uv = texel_triangle(topology, triangle);
  const glm::dvec2 a = uv[1] - uv[0];
  const glm::dvec2 b = uv[2] - uv[0];
  const glm::dvec2 p = point - uv[0];
  const double area = cross(a, b);
  return {cross(p, b) / area, cross(a, p) / area};
}

double smallest_weight(glm::dvec2 weights) {
  return std::min({1.0 - weights.x - weights.y, weights.x, weights.y});
}

glm::vec2 clamped(glm::dvec2 weights) {
  weights = glm::dvec2(std::clamp(weights.x, 0.0, 1.0), std::clamp(weights.y, 0.0, 1.0));
  const double sum = weights.x + weights.y;
  if (sum > 1.0) weights /= sum;
  return {static_cast<float>(weights.x), static_cast<float>(weights.y)};
}

/// The fragment's triangle that holds the point best, if any does (within rounding).
bool find_triangle(const MapTopology& topology, const std::vector<Fragment>& own, glm::dvec2 point,
                   TexelSample& sample) {
  double best = -1e-9;
  bool found = false;
  for (const Fragment& f : own) {
    const glm::dvec2 weights = barycentric_at(topology, f.triangle, point);
    const double least = smallest_weight(weights);
    if (least < best || (found && least <= best)) continue;
    best = least;
    found = true;
    sample.triangle = f.triangle;
    sample.barycentric = clamped(weights);
  }
  return found;
}

TexelSample find_sample(const MapTopology& topology, const std::vector<Fragment>& own) {
  TexelSample sample{};
  double area = 0.0;
  glm::dvec2 weighted(0.0);
  const Fragment* largest = &own.front();
  for (const Fragment& f : own) {
    area += f.area;
    weighted += f.area * f.centroid;
    if (f.area > largest->area) largest = &f;
  }
  sample.coverage = static_cast<float>(std::min(area, 1.0));
  const int32_t texel = own.front().texel;
  const glm::dvec2 centre(texel % topology.resolution + 0.5, texel / topology.resolution + 0.5);
  if (find_triangle(topology, own, centre, sample)) return sample;
  if (find_triangle(topology, own, weighted / area, sample)) return sample;
  sample.triangle = largest->triangle;
  sample.barycentric = clamped(barycentric_at(topology, largest->triangle, largest->centroid));
  return sample;
}

}  // namespace

void append_texel(TexelDraft& draft, int32_t chart, const std::vector<Fragment>& own) {
  const TexelSample sample = find_sample(draft.topology, own);
  draft.table.texel.push_back(own.front().texel);
  draft.table.triangle.push_back(sample.triangle);
  draft.table.barycentric.push_back(sample.barycentric);
  draft.table.chart.push_back(chart);
  draft.table.coverage.push_back(sample.coverage);
  for (const Fragment& f : own) {
    draft.table.fragment_triangle.push_back(f.triangle);
    draft.table.fragment_share.push_back(static_cast<float>(f.area));
  }
  draft.table.fragment_begin.push_back(static_cast<int32_t>(draft.table.fragment_triangle.size()));
  ++draft.own_texels[chart];
}

}  // namespace snowbough::snow
