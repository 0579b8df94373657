#include "snow/seams/seam_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

namespace snowbough::snow {
namespace {

/// With four samples per texel, the curve between two samples is negligible.
constexpr double kPointsPerTexel = 4.0;
constexpr float kMinHeight = 0.025f;
/// Metres; texels of a mesh that is scaled to nothing have no size.
constexpr float kMinHeightOfAll = 1e-6f;

/// A point of one side of a seam, in texels.
glm::dvec2 edge_point(const MapTopology& topology, TriangleEdge side, double part) {
  const glm::vec2* uv = topology.corner_uv.data() + 3 * static_cast<size_t>(side.triangle);
  const glm::dvec2 from(uv[side.edge]);
  const glm::dvec2 to(uv[(side.edge + 1) % 3]);
  return (from + (to - from) * part) * static_cast<double>(topology.resolution);
}

double edge_length(const MapTopology& topology, TriangleEdge side) {
  return glm::length(edge_point(topology, side, 1.0) - edge_point(topology, side, 0.0));
}

/// The terms of one point.
class PointTerms {
 public:
  /// Adds `weight` times the terms of a bilinear read of the map at `at` (in texels). `is_foreign`
  /// tells which texels another chart owns: they are stored as ~texel.
  template <typename IsForeign>
  void read_map(glm::dvec2 at, int32_t resolution, double weight, const IsForeign& is_foreign) {
    const glm::dvec2 corner = glm::floor(at - 0.5);
    const glm::dvec2 part = at - 0.5 - corner;
    for (int k = 0; k < 4; ++k) {
      const int dx = k & 1;
      const int dy = k >> 1;
      const double share = (dx ? part.x : 1.0 - part.x) * (dy ? part.y : 1.0 - part.y);
      if (share <= 0.0) continue;
      const int32_t column = std::clamp(static_cast<int32_t>(corner.x) + dx, 0, resolution - 1);
      const int32_t row = std::clamp(static_cast<int32_t>(corner.y) + dy, 0, resolution - 1);
      const int32_t texel = row * resolution + column;
      add(is_foreign(texel) ? ~texel : texel, weight * share);
    }
  }

  /// Sources are still texels of the map; `none` for unused terms.
  SeamRow row(int32_t none) const {
    SeamRow row;
    row.source.fill(none);
    for (size_t t = 0; t < count_; ++t) {
      row.source[t] = terms_[t].first;
      row.weight[t] = static_cast<float>(terms_[t].second);
    }
    return row;
  }

 private:
  void add(int32_t source, double weight) {
    const auto end = terms_.begin() + count_;
    const auto known =
        std::find_if(terms_.begin(), end, [&](const auto& term) { return term.first == source; });
    if (known != end) {
      known->second += weight;
    } else {
      terms_[count_++] = {source, weight};
    }
  }

  std::array<std::pair<int32_t, double>, kSeamTerms> terms_{};
  size_t count_ = 0;
};

/// Replaces the points' map texels, 0 to `none`, by indices into `texel`, and fills `texel`.
void number_texels(SeamLevelling& levelling, int32_t none) {
  // Per texel of the map: its index, if known. There are few texels of other charts.
  std::vector<int32_t> index(static_cast<size_t>(none), -1);
  std::vector<int32_t> foreign;
  for (const SeamRow& point : levelling.points) {
    for (const int32_t source : point.source) {
      if (source < 0) foreign.push_back(~source);
      if (source >= 0 && source < none) index[source] = 0;
    }
  }
  std::vector<int32_t>& texel = levelling.texel;
  for (int32_t t = 0; t < none; ++t) {
    if (index[t] < 0) continue;
    index[t] = static_cast<int32_t>(texel.size());
    texel.push_back(t);
  }
  levelling.unknowns = static_cast<int32_t>(texel.size());
  std::sort(foreign.begin(), foreign.end());
  foreign.erase(std::unique(foreign.begin(), foreign.end()), foreign.end());
  texel.insert(texel.end(), foreign.begin(), foreign.end());
  for (SeamRow& point : levelling.points) {
    for (int32_t& source : point.source) {
      if (source == none) {
        source = static_cast<int32_t>(texel.size());
      } else if (source >= 0) {
        source = index[source];
      } else {
        const auto found = std::lower_bound(foreign.begin(), foreign.end(), ~source);
        source = levelling.unknowns + static_cast<int32_t>(found - foreign.begin());
      }
    }
  }
}

}  // namespace

SeamLevelling find_seam_gaps(const MapTopology& topology, const TexelTable& table,
                             const Charts& charts, const std::vector<int32_t>& owned,
                             float texel_size) {
  const int32_t resolution = topology.resolution;
  const int32_t none = resolution * resolution;
  SeamLevelling levelling;
  levelling.least_height = std::max(kMinHeight * texel_size, kMinHeightOfAll);
  for (const Seam& seam : charts.seams) {
    const double length = std::max(edge_length(topology, seam.a), edge_length(topology, seam.b));
    const auto count = static_cast<int32_t>(std::ceil(kPointsPerTexel * length));
    for (int32_t p = 0; p < count; ++p) {
      const double part = (p + 0.5) / count;
      PointTerms terms;
      const auto add_side = [&](TriangleEdge side, double along, double weight) {
        terms.read_map(edge_point(topology, side, along), resolution, weight, [&](int32_t texel) {
          return owned[texel] >= 0 && table.chart[owned[texel]] != charts.chart[side.triangle];
        });
      };
      add_side(seam.a, part, -1.0);
      add_side(seam.b, seam.same_direction ? part : 1.0 - part, 1.0);
      levelling.points.push_back(terms.row(none));
    }
  }
  number_texels(levelling, none);
  return levelling;
}

}  // namespace snowbough::snow
