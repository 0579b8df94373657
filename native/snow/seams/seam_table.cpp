#include "snow/seams/seam_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>

#include "base/parallel_for.h"
#include "snow/seams/seam_walk.h"
#include "snow/seams/surface_metric.h"
#include "snow/texels/charts.h"

namespace snowbough::snow {
namespace {

using Terms = std::vector<std::pair<int32_t, double>>;

class SeamTableBuilder {
 public:
  SeamTableBuilder(const MapTopology& topology, const TexelTable& table,
                   const std::vector<glm::vec3>& positions)
      : topology_(topology),
        table_(table),
        charts_(find_charts(topology)),
        walk_(topology, charts_, positions),
        resolution_(topology.resolution),
        owned_(static_cast<size_t>(resolution_) * resolution_, -1) {
    for (size_t i = 0; i < table.texel.size(); ++i) {
      owned_[table.texel[i]] = static_cast<int32_t>(i);
    }
    const std::vector<SurfaceMetric> metrics = surface_metrics(topology, positions);
    for (const int32_t triangle : table.triangle) {
      const SurfaceMetric& metric = metrics[triangle];
      seams_.texel_size.emplace_back(std::sqrt(metric.uu), std::sqrt(metric.vv));
    }
    seams_.texel_area = texel_areas(topology, table, positions);
  }

  SeamTable build() {
    // They write disjoint members and read none of them.
    const std::array<std::function<void()>, 4> parts{
        [this] { dilate(); }, [this] { lay_lines(seams_.u, 0); },
        [this] { lay_lines(seams_.v, 1); },
        [this] {
          seams_.levelling = find_seam_gaps(topology_, table_, charts_, owned_, mean_texel_size());
        }};
    base::parallel_for(static_cast<int32_t>(parts.size()),
                       [&](size_t part, size_t) { parts[part](); });
    return std::move(seams_);
  }

 private:
  glm::dvec2 centre(int32_t texel) const {
    const int32_t row = texel / resolution_;
    return {texel % resolution_ + 0.5, row + 0.5};
  }

  /// Sample point of an owned texel's surface, in texels.
  glm::dvec2 sample_point(int32_t i) const {
    const glm::vec2* uv = topology_.corner_uv.data() + 3 * static_cast<size_t>(table_.triangle[i]);
    const glm::dvec2 w(table_.barycentric[i]);
    return (glm::dvec2(uv[0]) * (1.0 - w.x - w.y) + glm::dvec2(uv[1]) * w.x +
            glm::dvec2(uv[2]) * w.y) *
           static_cast<double>(resolution_);
  }

  float mean_texel_size() const {
    double sum = 0.0;
    for (const glm::vec2 s : seams_.texel_size) sum += std::sqrt(s.x * s.y);
    return static_cast<float>(sum / static_cast<double>(std::max<size_t>(1, table_.texel.size())));
  }

  /// Owned index of the texel at (column, row) if the chart owns it, else -1.
  int32_t own_at(int32_t chart, int32_t column, int32_t row) const {
    if (column < 0 || row < 0 || column >= resolution_ || row >= resolution_) return -1;
    const int32_t i = owned_[static_cast<size_t>(row) * resolution_ + column];
    return i >= 0 && table_.chart[i] == chart ? i : -1;
  }

  /// A point within some texels of the map: a walk across a sliver may end anywhere, or at NaN.
  glm::dvec2 near_map(const glm::dvec2& at) const {
    constexpr double kMargin = 16.0;
    const double last = table_.resolution + kMargin;
    return {std::min(std::max(-kMargin, at.x), last), std::min(std::max(-kMargin, at.y), last)};
  }

  /// Bilinear interpolation at a point of the surface. Texels that the chart does not own are
  /// looked up beyond the seam, once; those still missing are left out. Adds terms to `terms`,
  /// scaled to sum to `weight`, or none.
  void interpolate(const SurfacePoint& point, Terms& terms, double weight = 1.0,
                   bool beyond_seams = true) const {
    const glm::dvec2 at = near_map(point.at);
    const glm::dvec2 corner = glm::floor(at - 0.5);
    const glm::dvec2 part = at - 0.5 - corner;
    const size_t first = terms.size();
    for (int k = 0; k < 4; ++k) {
      const int dx = k & 1;
      const int dy = k >> 1;
      const double share = (dx ? part.x : 1.0 - part.x) * (dy ? part.y : 1.0 - part.y);
      if (share <= 1e-4) continue;
      const auto column = static_cast<int32_t>(corner.x) + dx;
      const auto row = static_cast<int32_t>(corner.y) + dy;
      const int32_t own = own_at(point.chart, column, row);
      if (own >= 0) {
        terms.emplace_back(own, share);
      } else if (beyond_seams) {
        SurfacePoint other = point;
        glm::dvec2 direction(0.0);
        if (walk_.go(other, glm::dvec2(column + 0.5, row + 0.5), direction)) {
          interpolate(other, terms, share, false);
        }
      }
    }
    scale_terms(terms, first, weight);
    if (terms.size() == first) add_nearest(point, weight, terms);
  }

  static void scale_terms(Terms& terms, size_t first, double weight) {
    double sum = 0.0;
    for (size_t i = first; i < terms.size(); ++i) sum += terms[i].second;
    if (sum < 1e-3) {
      terms.resize(first);
      return;
    }
    for (size_t i = first; i < terms.size(); ++i) terms[i].second *= weight / sum;
  }

  /// Adds the chart's own texel nearest to a point between texels of other charts.
  void add_nearest(const SurfacePoint& point, double weight, Terms& terms) const {
    const glm::dvec2 at = near_map(point.at);
    const auto column = static_cast<int32_t>(std::floor(at.x));
    const auto row = static_cast<int32_t>(std::floor(at.y));
    double best = 1e30;
    int32_t nearest = -1;
    for (int32_t dy = -2; dy <= 2; ++dy) {
      for (int32_t dx = -2; dx <= 2; ++dx) {
        const int32_t own = own_at(point.chart, column + dx, row + dy);
        if (own < 0) continue;
        const glm::dvec2 d = centre(table_.texel[own]) - point.at;
        if (glm::dot(d, d) < best) {
          best = glm::dot(d, d);
          nearest = own;
        }
      }
    }
    if (nearest >= 0) terms.emplace_back(nearest, weight);
  }

  static void append_row(WeightedRows& rows, Terms& terms) {
    std::sort(terms.begin(), terms.end());
    for (size_t i = 0; i < terms.size(); ++i) {
      if (i > 0 && terms[i].first == terms[i - 1].first) {
        rows.weight.back() += static_cast<float>(terms[i].second);
      } else {
        rows.source.push_back(terms[i].first);
        rows.weight.push_back(static_cast<float>(terms[i].second));
      }
    }
    rows.begin.push_back(static_cast<int32_t>(rows.source.size()));
  }

  /// Whether two adjacent texels are also neighbours on the surface.
  bool joined(int32_t a, int32_t b) const {
    if (table_.chart[a] != table_.chart[b]) return false;
    if (table_.coverage[a] >= 1.0f && table_.coverage[b] >= 1.0f) return true;
    return !walk_.leaves_chart(table_.chart[a], sample_point(a), sample_point(b));
  }

  /// Adds ghosts beyond the end `i` of a run, outwards along `step`, at places from `place` on with
  /// stride `place_step`.
  void add_ghosts(TexelLines& lines, int32_t i, glm::dvec2 step, int32_t place, int32_t place_step,
                  Terms& terms) const {
    SurfacePoint point{table_.chart[i], sample_point(i)};
    glm::dvec2 direction = step;
    glm::dvec2 target = centre(table_.texel[i]) + step;
    bool alive = true;
    for (int32_t k = 0; k < kFilterReach; ++k) {
      terms.clear();
      alive = alive && walk_.go(point, target, direction);
      if (alive) {
        interpolate(point, terms);
        target = point.at + direction;
      }
      lines.ghost_place.push_back(place + k * place_step);
      append_row(lines.ghosts, terms);
    }
  }

  /// Copies columns of `owned_` from `first` on into `columns`, consecutively: reading single
  /// columns would touch all of the map's memory.
  void copy_columns(int32_t first, int32_t count, std::vector<int32_t>& columns) const {
    for (int32_t row = 0; row < resolution_; ++row) {
      const int32_t* from = &owned_[static_cast<size_t>(row) * resolution_ + first];
      for (int32_t c = 0; c < count; ++c) {
        columns[static_cast<size_t>(c) * resolution_ + row] = from[c];
      }
    }
  }

  void lay_lines(TexelLines& lines, int axis) const {
    constexpr int32_t kColumns = 16;
    lines.place.assign(table_.texel.size(), -1);
    const glm::dvec2 step(axis == 0 ? 1.0 : 0.0, axis == 0 ? 0.0 : 1.0);
    std::vector<int32_t> columns(axis == 0 ? 0 : size_t{kColumns} * resolution_);
    Terms terms;
    int32_t place = 0;
    for (int32_t line = 0; line < resolution_; ++line) {
      if (axis == 1 && line % kColumns == 0) {
        copy_columns(line, std::min(kColumns, resolution_ - line), columns);
      }
      const int32_t* const at = axis == 0
                                    ? &owned_[static_cast<size_t>(line) * resolution_]
                                    : &columns[static_cast<size_t>(line % kColumns) * resolution_];
      for (int32_t k = 0; k < resolution_;) {
        const int32_t first = at[k];
        if (first < 0) {
          ++k;
          continue;
        }
        place += kFilterReach;
        const int32_t begin = place;
        int32_t last = first;
        lines.place[first] = place++;
        for (++k; k < resolution_; ++k) {
          const int32_t next = at[k];
          if (next < 0 || !joined(last, next)) break;
          lines.place[next] = place++;
          last = next;
        }
        add_ghosts(lines, first, -step, begin - 1, -1, terms);
        add_ghosts(lines, last, step, place, 1, terms);
        place += kFilterReach;
      }
    }
    lines.length = place;
  }

  /// Finds the nearest owned texel of every texel within kDilation, by rings of growing distance.
  void dilate() {
    std::vector<std::pair<int32_t, int32_t>> offsets;
    for (int32_t dy = -kDilation; dy <= kDilation; ++dy) {
      for (int32_t dx = -kDilation; dx <= kDilation; ++dx) offsets.emplace_back(dx, dy);
    }
    std::sort(offsets.begin(), offsets.end(), [](const auto& a, const auto& b) {
      const int32_t da = a.first * a.first + a.second * a.second;
      const int32_t db = b.first * b.first + b.second * b.second;
      return da != db ? da < db : a < b;
    });
    Terms terms;
    for (const int32_t texel : texels_near_charts()) {
      const int32_t column = texel % resolution_;
      const int32_t row = texel / resolution_;
      int32_t nearest = -1;
      for (const auto& [dx, dy] : offsets) {
        const int32_t x = column + dx;
        const int32_t y = row + dy;
        if (x < 0 || y < 0 || x >= resolution_ || y >= resolution_) continue;
        nearest = owned_[static_cast<size_t>(y) * resolution_ + x];
        if (nearest >= 0) break;
      }
      terms.clear();
      SurfacePoint point{table_.chart[nearest], sample_point(nearest)};
      glm::dvec2 direction(0.0);
      if (walk_.go(point, centre(texel), direction)) interpolate(point, terms);
      if (terms.empty()) terms.emplace_back(nearest, 1.0);
      seams_.dilated.push_back(texel);
      seams_.dilated_nearest.push_back(nearest);
      append_row(seams_.dilated_rows, terms);
    }
  }

  std::vector<int32_t> texels_near_charts() const {
    std::vector<int32_t> near;
    std::vector<bool> seen(owned_.size(), false);
    for (const int32_t texel : table_.texel) {
      const int32_t column = texel % resolution_;
      const int32_t row = texel / resolution_;
      const bool inner = column > 0 && row > 0 && column + 1 < resolution_ &&
                         row + 1 < resolution_ && owned_[texel - 1] >= 0 &&
                         owned_[texel + 1] >= 0 && owned_[texel - resolution_] >= 0 &&
                         owned_[texel + resolution_] >= 0;
      if (inner) continue;
      for (int32_t y = std::max(0, row - kDilation);
           y <= std::min(resolution_ - 1, row + kDilation); ++y) {
        for (int32_t x = std::max(0, column - kDilation);
             x <= std::min(resolution_ - 1, column + kDilation); ++x) {
          const int32_t other = y * resolution_ + x;
          if (owned_[other] >= 0 || seen[other]) continue;
          seen[other] = true;
          near.push_back(other);
        }
      }
    }
    std::sort(near.begin(), near.end());
    return near;
  }

  const MapTopology& topology_;
  const TexelTable& table_;
  const Charts charts_;
  SeamWalk walk_;
  int32_t resolution_;
  /// Per texel of the map: its index among the owned ones, or -1.
  std::vector<int32_t> owned_;
  SeamTable seams_;
};

}  // namespace

SeamTable build_seam_table(const MapTopology& topology, const TexelTable& table,
                           const std::vector<glm::vec3>& positions) {
  if (positions.size() != static_cast<size_t>(topology.vertex_count)) {
    throw std::invalid_argument("the seam table needs " + std::to_string(topology.vertex_count) +
                                " positions, not " + std::to_string(positions.size()));
  }
  return SeamTableBuilder(topology, table, positions).build();
}

void fill_lines(const TexelLines& lines, const std::vector<float>& values,
                std::vector<float>& line) {
  line.assign(static_cast<size_t>(lines.length), kNothing);
  for (size_t i = 0; i < values.size(); ++i) line[lines.place[i]] = values[i];
  for (size_t g = 0; g < lines.ghost_place.size(); ++g) {
    if (lines.ghosts.begin[g] == lines.ghosts.begin[g + 1]) continue;
    line[lines.ghost_place[g]] = lines.ghosts.sum(g, values);
  }
}

}  // namespace snowbough::snow
