#include <algorithm>
#include <utility>

#include "snow/texels/texel_table_builder.h"

namespace snowbough::snow {
namespace {

/// A point of a triangle, in texels of the map.
glm::dvec2 on_map(const MapTopology& topology, int32_t triangle, glm::vec2 barycentric) {
  const UvTriangle uv = texel_triangle(topology, triangle);
  const glm::dvec2 weight(barycentric);
  return uv[0] + weight.x * (uv[1] - uv[0]) + weight.y * (uv[2] - uv[0]);
}

/// Gives each texel of `takings` (owned index, ascending after sorting) to the chart of the
/// fragments beside it; what its old owner held there is displaced.
void hand_over(TexelDraft& draft, std::vector<std::pair<size_t, std::vector<Fragment>>>& takings) {
  if (takings.empty()) return;
  std::sort(takings.begin(), takings.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  const TexelTable before = std::move(draft.table);
  draft.table = TexelTable{};
  draft.table.resolution = before.resolution;
  draft.table.chart_count = before.chart_count;
  draft.table.degenerate_triangles = before.degenerate_triangles;
  draft.table.homeless_charts = before.homeless_charts;
  draft.table.overlap = before.overlap;
  draft.table.fragment_begin.push_back(0);
  TexelSampler sampler(draft.topology);
  auto next = takings.begin();
  for (size_t i = 0; i < before.texel.size(); ++i) {
    const int32_t begin = before.fragment_begin[i];
    const int32_t end = before.fragment_begin[i + 1];
    if (next != takings.end() && next->first == i) {
      for (int32_t f = begin; f < end; ++f) {
        const int32_t triangle = before.fragment_triangle[f];
        draft.displaced.push_back(
            {before.texel[i], triangle, static_cast<double>(before.fragment_share[f]),
             on_map(draft.topology, triangle, before.fragment_barycentric[f]), 0});
      }
      const std::vector<Fragment>& own = next->second;
      const TexelSample sample = sampler.of(own);
      draft.table.texel.push_back(before.texel[i]);
      draft.table.triangle.push_back(sample.triangle);
      draft.table.barycentric.push_back(sample.barycentric);
      draft.table.chart.push_back(draft.chart_of(own.front().triangle));
      draft.table.coverage.push_back(sample.coverage);
      for (const Fragment& f : own) {
        draft.table.fragment_triangle.push_back(f.triangle);
        draft.table.fragment_share.push_back(static_cast<float>(f.area));
        draft.table.fragment_barycentric.push_back(sampler.centroid(f));
      }
      draft.table.fragment_begin.push_back(
          static_cast<int32_t>(draft.table.fragment_triangle.size()));
      ++next;
      continue;
    }
    draft.table.texel.push_back(before.texel[i]);
    draft.table.triangle.push_back(before.triangle[i]);
    draft.table.barycentric.push_back(before.barycentric[i]);
    draft.table.chart.push_back(before.chart[i]);
    draft.table.coverage.push_back(before.coverage[i]);
    draft.table.fragment_triangle.insert(draft.table.fragment_triangle.end(),
                                         before.fragment_triangle.begin() + begin,
                                         before.fragment_triangle.begin() + end);
    draft.table.fragment_share.insert(draft.table.fragment_share.end(),
                                      before.fragment_share.begin() + begin,
                                      before.fragment_share.begin() + end);
    draft.table.fragment_barycentric.insert(draft.table.fragment_barycentric.end(),
                                            before.fragment_barycentric.begin() + begin,
                                            before.fragment_barycentric.begin() + end);
    draft.table.fragment_begin.push_back(
        static_cast<int32_t>(draft.table.fragment_triangle.size()));
  }
  // What the new owners hold is displaced no longer.
  std::erase_if(draft.displaced, [&](const Fragment& f) {
    const size_t i = draft.owned_index(f.texel);
    return draft.table.chart[i] == draft.chart_of(f.triangle);
  });
}

}  // namespace

void give_homeless_charts_a_texel(TexelDraft& draft) {
  std::vector<Fragment> homeless;
  for (const Fragment& f : draft.displaced) {
    if (draft.own_texels[draft.chart_of(f.triangle)] == 0) homeless.push_back(f);
  }
  if (homeless.empty()) return;
  std::sort(homeless.begin(), homeless.end(), [&](const Fragment& a, const Fragment& b) {
    const int32_t chart_a = draft.chart_of(a.triangle);
    const int32_t chart_b = draft.chart_of(b.triangle);
    if (chart_a != chart_b) return chart_a < chart_b;
    return a.texel != b.texel ? a.texel < b.texel : a.triangle < b.triangle;
  });

  struct Claim {
    double area;
    size_t begin;
    size_t end;
  };
  // New owners by owned index, applied in one go below.
  std::vector<std::pair<size_t, std::vector<Fragment>>> takings;
  std::vector<bool> taken(draft.table.texel.size(), false);
  for (size_t begin = 0; begin < homeless.size();) {
    const int32_t chart = draft.chart_of(homeless[begin].triangle);
    std::vector<Claim> claims;
    size_t end = begin;
    while (end < homeless.size() && draft.chart_of(homeless[end].triangle) == chart) {
      Claim claim{0.0, end, end};
      while (claim.end < homeless.size() && draft.chart_of(homeless[claim.end].triangle) == chart &&
             homeless[claim.end].texel == homeless[end].texel) {
        claim.area += homeless[claim.end++].area;
      }
      end = claim.end;
      claims.push_back(claim);
    }
    std::stable_sort(claims.begin(), claims.end(),
                     [](const Claim& a, const Claim& b) { return a.area > b.area; });
    bool settled = false;
    for (const Claim& claim : claims) {
      const size_t owned = draft.owned_index(homeless[claim.begin].texel);
      if (taken[owned] || draft.own_texels[draft.table.chart[owned]] < 2) continue;
      taken[owned] = true;
      --draft.own_texels[draft.table.chart[owned]];
      ++draft.own_texels[chart];
      takings.emplace_back(owned, std::vector<Fragment>(homeless.begin() + claim.begin,
                                                        homeless.begin() + claim.end));
      settled = true;
      break;
    }
    if (!settled) ++draft.table.homeless_charts;
    begin = end;
  }
  hand_over(draft, takings);
}

}  // namespace snowbough::snow
