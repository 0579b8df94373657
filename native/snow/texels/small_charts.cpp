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

/// Assigns each texel of `assignments` (owned index, ascending after sorting) to the chart of its
/// fragments; its old owner's fragments there become displaced.
void assign(TexelTableBuilder& builder,
            std::vector<std::pair<size_t, std::vector<Fragment>>>& assignments) {
  if (assignments.empty()) return;
  std::sort(assignments.begin(), assignments.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  const TexelTable before = std::move(builder.table);
  builder.table = TexelTable{};
  builder.table.resolution = before.resolution;
  builder.table.chart_count = before.chart_count;
  builder.table.degenerate_triangles = before.degenerate_triangles;
  builder.table.unmapped_charts = before.unmapped_charts;
  builder.table.overlap = before.overlap;
  builder.table.fragment_begin.push_back(0);
  TexelSampler sampler(builder.topology);
  auto next = assignments.begin();
  for (size_t i = 0; i < before.texel.size(); ++i) {
    const int32_t begin = before.fragment_begin[i];
    const int32_t end = before.fragment_begin[i + 1];
    if (next != assignments.end() && next->first == i) {
      for (int32_t f = begin; f < end; ++f) {
        const int32_t triangle = before.fragment_triangle[f];
        builder.displaced.push_back(
            {before.texel[i], triangle, static_cast<double>(before.fragment_share[f]),
             on_map(builder.topology, triangle, before.fragment_barycentric[f]), 0});
      }
      const std::vector<Fragment>& own = next->second;
      const TexelSample sample = sampler.of(own);
      builder.table.texel.push_back(before.texel[i]);
      builder.table.triangle.push_back(sample.triangle);
      builder.table.barycentric.push_back(sample.barycentric);
      builder.table.chart.push_back(builder.chart_of(own.front().triangle));
      builder.table.coverage.push_back(sample.coverage);
      for (const Fragment& f : own) {
        builder.table.fragment_triangle.push_back(f.triangle);
        builder.table.fragment_share.push_back(static_cast<float>(f.area));
        builder.table.fragment_barycentric.push_back(sampler.centroid(f));
      }
      builder.table.fragment_begin.push_back(
          static_cast<int32_t>(builder.table.fragment_triangle.size()));
      ++next;
      continue;
    }
    builder.table.texel.push_back(before.texel[i]);
    builder.table.triangle.push_back(before.triangle[i]);
    builder.table.barycentric.push_back(before.barycentric[i]);
    builder.table.chart.push_back(before.chart[i]);
    builder.table.coverage.push_back(before.coverage[i]);
    builder.table.fragment_triangle.insert(builder.table.fragment_triangle.end(),
                                           before.fragment_triangle.begin() + begin,
                                           before.fragment_triangle.begin() + end);
    builder.table.fragment_share.insert(builder.table.fragment_share.end(),
                                        before.fragment_share.begin() + begin,
                                        before.fragment_share.begin() + end);
    builder.table.fragment_barycentric.insert(builder.table.fragment_barycentric.end(),
                                              before.fragment_barycentric.begin() + begin,
                                              before.fragment_barycentric.begin() + end);
    builder.table.fragment_begin.push_back(
        static_cast<int32_t>(builder.table.fragment_triangle.size()));
  }
  // The new owners' fragments are no longer displaced.
  std::erase_if(builder.displaced, [&](const Fragment& f) {
    const size_t i = builder.owned_index(f.texel);
    return builder.table.chart[i] == builder.chart_of(f.triangle);
  });
}

}  // namespace

void assign_texels_to_small_charts(TexelTableBuilder& builder) {
  std::vector<Fragment> unmapped;
  for (const Fragment& f : builder.displaced) {
    if (builder.own_texels[builder.chart_of(f.triangle)] == 0) unmapped.push_back(f);
  }
  if (unmapped.empty()) return;
  std::sort(unmapped.begin(), unmapped.end(), [&](const Fragment& a, const Fragment& b) {
    const int32_t chart_a = builder.chart_of(a.triangle);
    const int32_t chart_b = builder.chart_of(b.triangle);
    if (chart_a != chart_b) return chart_a < chart_b;
    return a.texel != b.texel ? a.texel < b.texel : a.triangle < b.triangle;
  });

  struct Candidate {
    double area;
    size_t begin;
    size_t end;
  };
  // New owners by owned index, applied together below.
  std::vector<std::pair<size_t, std::vector<Fragment>>> assignments;
  std::vector<bool> is_assigned(builder.table.texel.size(), false);
  for (size_t begin = 0; begin < unmapped.size();) {
    const int32_t chart = builder.chart_of(unmapped[begin].triangle);
    std::vector<Candidate> candidates;
    size_t end = begin;
    while (end < unmapped.size() && builder.chart_of(unmapped[end].triangle) == chart) {
      Candidate candidate{0.0, end, end};
      while (candidate.end < unmapped.size() &&
             builder.chart_of(unmapped[candidate.end].triangle) == chart &&
             unmapped[candidate.end].texel == unmapped[end].texel) {
        candidate.area += unmapped[candidate.end++].area;
      }
      end = candidate.end;
      candidates.push_back(candidate);
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.area > b.area; });
    bool assigned = false;
    for (const Candidate& candidate : candidates) {
      const size_t owned = builder.owned_index(unmapped[candidate.begin].texel);
      if (is_assigned[owned] || builder.own_texels[builder.table.chart[owned]] < 2) continue;
      is_assigned[owned] = true;
      --builder.own_texels[builder.table.chart[owned]];
      ++builder.own_texels[chart];
      assignments.emplace_back(owned, std::vector<Fragment>(unmapped.begin() + candidate.begin,
                                                            unmapped.begin() + candidate.end));
      assigned = true;
      break;
    }
    if (!assigned) ++builder.table.unmapped_charts;
    begin = end;
  }
  assign(builder, assignments);
}

}  // namespace snowbough::snow
