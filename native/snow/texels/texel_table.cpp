#include "snow/texels/texel_table.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/thread_pool.h"
#include "snow/texels/texel_table_builder.h"

namespace snowbough::snow {
namespace {

constexpr int32_t kMinResolution = 64;
constexpr int32_t kMaxResolution = 8192;
/// Tolerance for coordinates outside [0, 1]: rounding in layout tools.
constexpr float kUvSlack = 1e-4f;

void check_topology(const MapTopology& topology) {
  if (topology.resolution < kMinResolution || topology.resolution > kMaxResolution) {
    throw std::invalid_argument("resolution must be from 64 to 8192, not " +
                                std::to_string(topology.resolution));
  }
  if (topology.triangles.empty() || topology.triangles.size() % 3 != 0) {
    throw std::invalid_argument(
        "triangles must hold three vertex indices each, and at least one triangle");
  }
  if (topology.corner_uv.size() != topology.triangles.size()) {
    throw std::invalid_argument("uv must hold one coordinate per triangle corner: " +
                                std::to_string(topology.triangles.size()) + ", not " +
                                std::to_string(topology.corner_uv.size()));
  }
  for (const int32_t index : topology.triangles) {
    if (index < 0 || index >= topology.vertex_count) {
      throw std::invalid_argument("triangle index " + std::to_string(index) + " is out of range: " +
                                  std::to_string(topology.vertex_count) + " vertices");
    }
  }
  int64_t outside = 0;
  for (const glm::vec2 uv : topology.corner_uv) {
    const bool inside = uv.x >= -kUvSlack && uv.x <= 1.0f + kUvSlack && uv.y >= -kUvSlack &&
                        uv.y <= 1.0f + kUvSlack;
    if (!inside) ++outside;
  }
  if (outside > 0) {
    throw std::invalid_argument(
        std::to_string(outside) + " of " + std::to_string(topology.corner_uv.size()) +
        " texture coordinates lie outside [0, 1]: a snow map needs a UV layout "
        "that fits the unit square (pack the islands)");
  }
}

/// Divides areas by their triangles' sum of cut areas instead of the triangles' own area, so that
/// the shares of slivers, whose cuts round coarsely, sum to 1 as well.
void shares_from_areas(TexelTableBuilder& builder) {
  for (size_t f = 0; f < builder.table.fragment_share.size(); ++f) {
    const double whole = builder.triangle_area[builder.table.fragment_triangle[f]];
    builder.table.fragment_share[f] = static_cast<float>(builder.table.fragment_share[f] / whole);
  }
}

}  // namespace

TexelTableBuilder::TexelTableBuilder(const MapTopology& given)
    : topology(given), charts(find_charts(given)) {
  table.resolution = topology.resolution;
  table.chart_count = charts.count;
  own_texels.assign(static_cast<size_t>(charts.count), 0);
}

size_t TexelTableBuilder::owned_index(int32_t at) const {
  return static_cast<size_t>(std::lower_bound(table.texel.begin(), table.texel.end(), at) -
                             table.texel.begin());
}

UvTriangle texel_triangle(const MapTopology& topology, int32_t triangle) {
  UvTriangle result;
  const auto size = static_cast<double>(topology.resolution);
  for (int32_t k = 0; k < 3; ++k) {
    const glm::vec2 uv = topology.corner_uv[3 * static_cast<size_t>(triangle) + k];
    result[k] = glm::dvec2(std::clamp(static_cast<double>(uv.x), 0.0, 1.0) * size,
                           std::clamp(static_cast<double>(uv.y), 0.0, 1.0) * size);
  }
  return result;
}

TexelTable build_texel_table(const MapTopology& topology, int32_t threads) {
  check_topology(topology);
  TexelTableBuilder builder(topology);
  cut_map(builder, threads > 0 ? threads : base::default_threads());
  assign_texels_to_small_charts(builder);
  reassign_displaced_fragments(builder);
  shares_from_areas(builder);
  return std::move(builder.table);
}

}  // namespace snowbough::snow
