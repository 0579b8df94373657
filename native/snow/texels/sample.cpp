#include <algorithm>

#include "snow/texels/texel_table_builder.h"

namespace snowbough::snow {
namespace {

double cross(glm::dvec2 a, glm::dvec2 b) {
  return a.x * b.y - a.y * b.x;
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

}  // namespace

void TexelSampler::prepare(int32_t triangle) {
  const UvTriangle uv = texel_triangle(topology_, triangle);
  const glm::dvec2 b = uv[1] - uv[0];
  const glm::dvec2 c = uv[2] - uv[0];
  frame_ = {triangle, uv[0], b, c, cross(b, c)};
}

/// Weights of the second and third corner.
inline glm::dvec2 TexelSampler::barycentric_at(int32_t triangle, glm::dvec2 point) {
  if (frame_.triangle != triangle) prepare(triangle);
  const glm::dvec2 p = point - frame_.corner;
  return {cross(p, frame_.side_c) / frame_.area, cross(frame_.side_b, p) / frame_.area};
}

/// Finds the fragment's triangle that contains the point best, if any does (within rounding).
bool TexelSampler::find_triangle(const std::vector<Fragment>& own, glm::dvec2 point,
                                 TexelSample& sample) {
  double best = -1e-9;
  bool found = false;
  for (const Fragment& f : own) {
    const glm::dvec2 weights = barycentric_at(f.triangle, point);
    const double least = smallest_weight(weights);
    if (least < best || (found && least <= best)) continue;
    best = least;
    found = true;
    sample.triangle = f.triangle;
    sample.barycentric = clamped(weights);
  }
  return found;
}

TexelSample TexelSampler::whole(int32_t triangle, glm::dvec2 centre) {
  return {triangle, clamped(barycentric_at(triangle, centre)), 1.0f};
}

glm::vec2 TexelSampler::centroid(const Fragment& fragment) {
  return clamped(barycentric_at(fragment.triangle, fragment.centroid));
}

TexelSample TexelSampler::of(const std::vector<Fragment>& own) {
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
  if (find_triangle(own, texel_centre(own.front().texel, topology_.resolution), sample)) {
    return sample;
  }
  if (find_triangle(own, weighted / area, sample)) return sample;
  sample.triangle = largest->triangle;
  sample.barycentric = clamped(barycentric_at(largest->triangle, largest->centroid));
  return sample;
}

}  // namespace snowbough::snow
