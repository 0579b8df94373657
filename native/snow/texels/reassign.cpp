#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "snow/texels/texel_table_builder.h"

namespace snowbough::snow {
namespace {

/// Index of the chart's own texel nearest to a point; searches rows outwards, and the columns of a
/// row by bisection.
size_t nearest_own_texel(const TexelTableBuilder& builder, const std::vector<int32_t>& own,
                         glm::dvec2 point) {
  const int32_t resolution = builder.table.resolution;
  const auto home_row = static_cast<int32_t>(std::floor(point.y));
  double best = std::numeric_limits<double>::infinity();
  int32_t best_texel = -1;
  const auto consider = [&](int32_t texel) {
    const glm::dvec2 d = glm::dvec2(texel % resolution + 0.5, texel / resolution + 0.5) - point;
    const double squared = d.x * d.x + d.y * d.y;
    if (squared < best || (squared == best && texel < best_texel)) {
      best = squared;
      best_texel = texel;
    }
  };
  const auto search_row = [&](int32_t row) {
    const int64_t wanted = static_cast<int64_t>(row) * resolution + static_cast<int64_t>(point.x);
    const auto at = std::lower_bound(own.begin(), own.end(), wanted,
                                     [](int32_t texel, int64_t w) { return texel < w; });
    if (at != own.end() && *at / resolution == row) consider(*at);
    if (at != own.begin() && *(at - 1) / resolution == row) consider(*(at - 1));
  };
  for (int32_t distance = 0; distance <= resolution; ++distance) {
    const double nearest_possible = std::max(0.0, distance - 1.0);
    if (nearest_possible * nearest_possible > best) break;
    if (home_row - distance >= 0) search_row(home_row - distance);
    if (distance > 0 && home_row + distance < resolution) search_row(home_row + distance);
  }
  return builder.owned_index(best_texel);
}

}  // namespace

void reassign_displaced_fragments(TexelTableBuilder& builder) {
  if (builder.displaced.empty()) return;
  std::vector<std::vector<int32_t>> own(static_cast<size_t>(builder.table.chart_count));
  for (const Fragment& f : builder.displaced) own[builder.chart_of(f.triangle)] = {-1};
  for (size_t i = 0; i < builder.table.texel.size(); ++i) {
    std::vector<int32_t>& texels = own[builder.table.chart[i]];
    if (!texels.empty()) texels.push_back(builder.table.texel[i]);
  }
  struct Part {
    int32_t triangle;
    float area;
    glm::vec2 barycentric;
  };
  struct Reassignment {
    size_t owned;
    Part part;
  };
  TexelSampler sampler(builder.topology);
  std::vector<Reassignment> reassignments;
  reassignments.reserve(builder.displaced.size());
  for (const Fragment& f : builder.displaced) {
    std::vector<int32_t>& texels = own[builder.chart_of(f.triangle)];
    if (texels.front() == -1) texels.erase(texels.begin());
    // An unmapped chart's area stays.
    const size_t owned = texels.empty() ? builder.owned_index(f.texel)
                                        : nearest_own_texel(builder, texels, f.centroid);
    if (texels.empty()) texels.push_back(-1);
    reassignments.push_back({owned, {f.triangle, static_cast<float>(f.area), sampler.centroid(f)}});
  }
  std::stable_sort(
      reassignments.begin(), reassignments.end(), [](const Reassignment& a, const Reassignment& b) {
        return a.owned != b.owned ? a.owned < b.owned : a.part.triangle < b.part.triangle;
      });

  std::vector<int32_t> begin{0};
  std::vector<int32_t> triangle;
  std::vector<float> area;
  std::vector<glm::vec2> barycentric;
  begin.reserve(builder.table.fragment_begin.size());
  triangle.reserve(builder.table.fragment_triangle.size() + reassignments.size());
  area.reserve(builder.table.fragment_triangle.size() + reassignments.size());
  barycentric.reserve(builder.table.fragment_triangle.size() + reassignments.size());
  std::vector<Part> merged;
  auto next = reassignments.begin();
  for (size_t i = 0; i < builder.table.texel.size(); ++i) {
    merged.clear();
    for (int32_t f = builder.table.fragment_begin[i]; f < builder.table.fragment_begin[i + 1];
         ++f) {
      merged.push_back({builder.table.fragment_triangle[f], builder.table.fragment_share[f],
                        builder.table.fragment_barycentric[f]});
    }
    if (next != reassignments.end() && next->owned == i) {
      for (; next != reassignments.end() && next->owned == i; ++next) {
        merged.push_back(next->part);
      }
      std::stable_sort(merged.begin(), merged.end(),
                       [](const Part& a, const Part& b) { return a.triangle < b.triangle; });
    }
    for (size_t m = 0; m < merged.size(); ++m) {
      const Part& part = merged[m];
      if (m > 0 && part.triangle == merged[m - 1].triangle) {
        area.back() += part.area;
        barycentric.back() += (part.barycentric - barycentric.back()) * (part.area / area.back());
      } else {
        triangle.push_back(part.triangle);
        area.push_back(part.area);
        barycentric.push_back(part.barycentric);
      }
    }
    begin.push_back(static_cast<int32_t>(triangle.size()));
  }
  builder.table.fragment_begin = std::move(begin);
  builder.table.fragment_triangle = std::move(triangle);
  builder.table.fragment_share = std::move(area);
  builder.table.fragment_barycentric = std::move(barycentric);
}

}  // namespace snowbough::snow
