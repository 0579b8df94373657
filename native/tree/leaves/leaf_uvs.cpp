#include "tree/leaves/leaf_uvs.h"

#include <algorithm>
#include <cstddef>
#include <glm/common.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "tree/leaves/leaf_charts.h"
#include "tree/uv/chart_shape.h"

namespace snowbough::tree {
namespace {

constexpr int kMinResolution = 16;
constexpr int kMaxResolution = 16384;
/// Progress at which all leaves are flat.
constexpr float kFlatDone = 0.8f;
/// Relative tolerance of the search for the scale.
constexpr double kScaleTolerance = 1e-3;
/// Maximum number of search steps, for charts that keep their minimum size at any scale.
constexpr int kSearchSteps = 40;

void check(const Foliage& foliage, int resolution) {
  if (resolution < kMinResolution || resolution > kMaxResolution) {
    throw std::invalid_argument("resolution must be " + std::to_string(kMinResolution) + " to " +
                                std::to_string(kMaxResolution) + ", not " +
                                std::to_string(resolution));
  }
  const std::vector<int32_t>& begin = foliage.face_begin;
  const size_t face_count = begin.empty() ? 0 : begin.size() - 1;
  const bool consistent =
      foliage.face_leaf.size() == face_count &&
      (begin.empty() ? foliage.corner_vertex.empty()
                     : begin.front() == 0 && std::is_sorted(begin.begin(), begin.end()) &&
                           static_cast<size_t>(begin.back()) == foliage.corner_vertex.size());
  if (!consistent) {
    throw std::invalid_argument("face_begin, face_leaf and corner_vertex are inconsistent");
  }
  for (const int32_t vertex : foliage.corner_vertex) {
    if (vertex < 0 || static_cast<size_t>(vertex) >= foliage.vertices.size()) {
      throw std::invalid_argument("foliage vertex " + std::to_string(vertex) + " is out of range");
    }
  }
}

/// Charts in layout order: the tallest first.
std::vector<LeafChart> sorted_charts(const std::vector<LeafChart>& charts) {
  // Heights together with indices, so that sorting reads nothing else.
  std::vector<std::pair<double, size_t>> order(charts.size());
  for (size_t i = 0; i < charts.size(); ++i) {
    order[i] = {-charts[i].size.y, i};
  }
  std::sort(order.begin(), order.end());
  std::vector<LeafChart> sorted;
  sorted.reserve(charts.size());
  for (const auto& [height, i] : order) {
    sorted.push_back(charts[i]);
  }
  return sorted;
}

glm::dvec2 extent_at(const LeafChart& chart, double scale) {
  return glm::max(chart.size * scale, glm::dvec2(kMinChartWidth));
}

int whole_texels(double extent) {
  const int texels = static_cast<int>(extent);
  return texels < extent ? texels + 1 : texels;
}

/// Places charts on shelves, from the bottom of the map up.
class Shelves {
 public:
  /// @param charts  the tallest first; not empty.
  explicit Shelves(const std::vector<LeafChart>& charts) : charts_(charts) {
    for (const LeafChart& chart : charts) {
      widest_ = std::max(widest_, chart.size.x);
    }
  }

  /// Side in metres of a square that contains any chart.
  double largest() const { return std::max(widest_, charts_.front().size.y); }

  /// True if all fit; `places` then receives their lower left texels.
  bool fill(double scale, int resolution, std::vector<glm::ivec2>& places) const {
    if (scale * largest() > resolution) {
      return false;
    }
    const int gutter = scale * widest_ > kWideChart ? 2 : 1;
    places.resize(charts_.size());
    const int last = resolution - 1;
    int x = 1;
    int y = 1;
    int shelf_height = 0;
    for (size_t i = 0; i < charts_.size(); ++i) {
      const glm::dvec2 extent = extent_at(charts_[i], scale);
      const int width = whole_texels(extent.x);
      if (x + width > last) {
        x = 1;
        y += shelf_height + gutter;
        shelf_height = 0;
      }
      if (shelf_height == 0) {
        shelf_height = whole_texels(extent.y);
      }
      if (x + width > last || y + shelf_height > last) {
        return false;
      }
      places[i] = {x, y};
      x += width + gutter;
    }
    return true;
  }

 private:
  const std::vector<LeafChart>& charts_;
  double widest_ = 0.0;
};

/// Nearly the largest scale at which the charts fit; negative if they do not fit at their minimum
/// size.
double search_scale(const Shelves& shelves, int resolution, std::vector<glm::ivec2>& places) {
  double low = 0.0;
  double high = resolution / shelves.largest();
  if (!shelves.fill(low, resolution, places)) {
    return -1.0;
  }
  for (int step = 0; step < kSearchSteps && high - low > kScaleTolerance * low; ++step) {
    const double middle = 0.5 * (low + high);
    (shelves.fill(middle, resolution, places) ? low : high) = middle;
  }
  shelves.fill(low, resolution, places);
  return low;
}

}  // namespace

LeafUvs layout_leaf_uvs(const Foliage& foliage, int resolution, const base::Execution& execution) {
  check(foliage, resolution);
  LeafUvs result;
  result.resolution = resolution;
  LeafCharts flat = flatten_leaves(foliage, execution.part(0.0f, kFlatDone));
  base::report_progress(execution.progress, kFlatDone);
  result.corner_uv = std::move(flat.points);
  result.chart_count = static_cast<int64_t>(flat.charts.size());
  if (flat.charts.empty()) {
    return result;
  }
  const std::vector<LeafChart> charts = sorted_charts(flat.charts);
  const Shelves shelves(charts);
  std::vector<glm::ivec2> places;
  result.scale = search_scale(shelves, resolution, places);
  for (int larger = kMinResolution; result.scale < 0.0; larger *= 2) {
    if (larger > kMaxResolution) {
      throw std::invalid_argument(
          "the foliage's " + std::to_string(charts.size()) + " charts do not fit a snow map of " +
          std::to_string(kMaxResolution) + ": leave out the foliage or thin it");
    }
    if (larger > resolution) {
      result.resolution = larger;
      result.scale = search_scale(shelves, larger, places);
    }
  }
  for (size_t i = 0; i < charts.size(); ++i) {
    const glm::dvec2 place = places[i];
    const glm::dvec2 stretch = extent_at(charts[i], result.scale) / charts[i].size;
    const double to_map = 1.0 / result.resolution;
    for (int32_t at = charts[i].first_face; at < charts[i].last_face; ++at) {
      const int32_t face = flat.faces[at];
      for (int32_t corner = foliage.face_begin[face]; corner < foliage.face_begin[face + 1];
           ++corner) {
        glm::vec2& uv = result.corner_uv[corner];
        uv = glm::vec2((place + glm::dvec2(uv) * stretch) * to_map);
      }
    }
  }
  return result;
}

}  // namespace snowbough::tree
