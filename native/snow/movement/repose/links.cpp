#include "snow/movement/repose/links.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

#include "base/group_by_key.h"
#include "snow/texels/charts.h"
#include "snow/texels/merge_vertices.h"

namespace snowbough::snow {
namespace {

/// Samples per texel along a seam or an open edge.
constexpr double kSamplesATexel = 2.0;

class LinkFinder {
 public:
  /// `topology`: merged.
  LinkFinder(const MapTopology& topology, const TexelTable& table)
      : topology_(topology),
        table_(table),
        charts_(find_charts(topology_)),
        resolution_(table.resolution),
        owned_(static_cast<size_t>(resolution_) * static_cast<size_t>(resolution_), -1) {
    for (size_t i = 0; i < table.texel.size(); ++i) {
      owned_[static_cast<size_t>(table.texel[i])] = static_cast<int32_t>(i);
    }
    links_.resolution = resolution_;
    links_.blocks_a_side = (resolution_ + kReposeBlock - 1) / kReposeBlock;
  }

  ReposeLinks find() {
    find_runs();
    link_neighbours();
    link_seams();
    find_open_edges();
    sort_ends();
    find_near_blocks();
    set_forward();
    return std::move(links_);
  }

 private:
  int32_t chart(int32_t i) const {
    return charts_.chart[static_cast<size_t>(table_.triangle[static_cast<size_t>(i)])];
  }
  int32_t place(int32_t i) const { return table_.texel[static_cast<size_t>(i)]; }
  /// The texel at (column, row), or -1.
  int32_t at(int32_t column, int32_t row) const {
    if (column < 0 || row < 0 || column >= resolution_ || row >= resolution_) return -1;
    return owned_[static_cast<size_t>(row) * static_cast<size_t>(resolution_) +
                  static_cast<size_t>(column)];
  }

  void find_runs() {
    const int32_t blocks = links_.blocks_a_side;
    links_.run_begin.assign(static_cast<size_t>(resolution_) * static_cast<size_t>(blocks) + 1, 0);
    for_each_place(table_, [&](int32_t, int32_t column, int32_t row) {
      ++links_.run_begin[static_cast<size_t>(row * blocks + column / kReposeBlock) + 1];
    });
    std::partial_sum(links_.run_begin.begin(), links_.run_begin.end(), links_.run_begin.begin());
  }

  /// Whether two triangles share a vertex.
  bool touch(int32_t s, int32_t t) const {
    const int32_t* a = &topology_.triangles[3 * static_cast<size_t>(s)];
    const int32_t* b = &topology_.triangles[3 * static_cast<size_t>(t)];
    return std::find_first_of(a, a + 3, b, b + 3) != a + 3;
  }

  /// Whether two adjacent texels are also neighbours on the surface: one triangle covers their
  /// common edge in both, or, where a mesh edge runs along it, two triangles that share a vertex.
  bool joined(int32_t i, int32_t j) const {
    if (chart(i) != chart(j)) return false;
    const auto begin = [&](int32_t k) { return table_.fragment_begin[static_cast<size_t>(k)]; };
    for (int32_t f = begin(i); f < begin(i + 1); ++f) {
      for (int32_t g = begin(j); g < begin(j + 1); ++g) {
        const int32_t s = table_.fragment_triangle[static_cast<size_t>(f)];
        const int32_t t = table_.fragment_triangle[static_cast<size_t>(g)];
        if (s == t || touch(s, t)) return true;
      }
    }
    return false;
  }

  bool is_linked(int32_t i, int32_t k) const {
    return i >= 0 && ((forward_[static_cast<size_t>(i)] >> k) & 1) != 0;
  }

  void link_neighbours() {
    forward_.assign(table_.texel.size(), 0);
    for_each_place(table_, [&](int32_t i, int32_t column, int32_t row) {
      for (int32_t k = 0; k < 2; ++k) {
        const int32_t j = at(column + kForwardColumn[k], row + kForwardRow[k]);
        if (j >= 0 && joined(i, j)) {
          forward_[static_cast<size_t>(i)] |= static_cast<uint8_t>(1 << k);
        }
      }
    });
    // Diagonal links, if a path around the corner is open.
    for_each_place(table_, [&](int32_t i, int32_t column, int32_t row) {
      const int32_t right = at(column + 1, row);
      const int32_t left = at(column - 1, row);
      const int32_t above = at(column, row + 1);
      const int32_t above_left = at(column - 1, row + 1);
      uint8_t& own = forward_[static_cast<size_t>(i)];
      if ((is_linked(i, 0) && is_linked(right, 1)) || (is_linked(i, 1) && is_linked(above, 0))) {
        own |= 4;
      }
      if ((is_linked(left, 0) && is_linked(left, 1)) ||
          (is_linked(i, 1) && is_linked(above_left, 0))) {
        own |= 8;
      }
    });
  }

  void set_forward() {
    const auto side = static_cast<size_t>(links_.blocks_a_side);
    links_.forward.assign(side * side * kTileCells, 0);
    for_each_place(table_, [&](int32_t i, int32_t column, int32_t row) {
      links_.forward[static_cast<size_t>(links_.cell_at(column, row))] =
          forward_[static_cast<size_t>(i)] | kHasTexel;
    });
  }

  glm::dvec2 corner(int32_t triangle, int32_t k) const {
    return glm::dvec2(topology_.corner_uv[3 * static_cast<size_t>(triangle) +
                                          static_cast<size_t>(k % 3)]) *
           static_cast<double>(resolution_);
  }

  double length(TriangleEdge side) const {
    return glm::length(corner(side.triangle, side.edge + 1) - corner(side.triangle, side.edge));
  }

  /// The texel of the side's own chart next to a point on it, at fraction `part` of its length; -1:
  /// none is near.
  int32_t texel_beside(TriangleEdge side, double part) const {
    const glm::dvec2 begin = corner(side.triangle, side.edge);
    const glm::dvec2 end = corner(side.triangle, side.edge + 1);
    const glm::dvec2 on = begin + (end - begin) * part;
    const glm::dvec2 inwards = corner(side.triangle, side.edge + 2) - on;
    const double size = glm::length(inwards);
    const glm::dvec2 point = on + inwards * (size > 0.0 ? std::min(0.25, 0.5 * size) / size : 0.0);
    const auto column = static_cast<int32_t>(std::floor(point.x));
    const auto row = static_cast<int32_t>(std::floor(point.y));
    const int32_t own = charts_.chart[static_cast<size_t>(side.triangle)];
    int32_t nearest = -1;
    double least = 1e30;
    for (int32_t dy = -1; dy <= 1; ++dy) {
      for (int32_t dx = -1; dx <= 1; ++dx) {
        const int32_t i = at(column + dx, row + dy);
        if (i < 0 || chart(i) != own) continue;
        const glm::dvec2 away = glm::dvec2(column + dx + 0.5, row + dy + 0.5) - point;
        const double distance = dx == 0 && dy == 0 ? -1.0 : glm::dot(away, away);
        if (distance < least) {
          least = distance;
          nearest = i;
        }
      }
    }
    return nearest;
  }

  /// Whether two texels are linked on the map.
  bool are_neighbours(int32_t i, int32_t j) const {
    for (int32_t k = 0; k < kForwardLinks; ++k) {
      const int32_t step = kForwardRow[k] * resolution_ + kForwardColumn[k];
      if ((is_linked(i, k) && place(j) == place(i) + step) ||
          (is_linked(j, k) && place(i) == place(j) + step)) {
        return true;
      }
    }
    return false;
  }

  static int32_t sample_count(double texels) {
    return std::max(1, static_cast<int32_t>(std::ceil(kSamplesATexel * std::min(texels, 1e6))));
  }

  void link_seams() {
    for (const Seam& seam : charts_.seams) {
      const int32_t samples = sample_count(std::max(length(seam.a), length(seam.b)));
      for (int32_t k = 0; k < samples; ++k) {
        const double part = (k + 0.5) / samples;
        const int32_t a = texel_beside(seam.a, part);
        const int32_t b = texel_beside(seam.b, seam.same_direction ? part : 1.0 - part);
        if (a < 0 || b < 0 || a == b || are_neighbours(a, b)) continue;
        links_.across.push_back({std::min(a, b), std::max(a, b), point_of(seam.a, part)});
      }
    }
    // Of several samples shared by two texels, keeps the middle one.
    std::vector<ReposeLinks::Across>& all = links_.across;
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& s, const auto& t) { return s.ends() < t.ends(); });
    size_t count = 0;
    for (size_t begin = 0, end = 0; begin < all.size(); begin = end) {
      while (end < all.size() && all[end].ends() == all[begin].ends()) ++end;
      all[count++] = all[(begin + end) / 2];
    }
    all.resize(count);
  }

  /// The point at fraction `part` of a triangle's side.
  static ReposeLinks::Point point_of(TriangleEdge side, double part) {
    std::array<float, 3> weights{};
    weights[static_cast<size_t>(side.edge)] = static_cast<float>(1.0 - part);
    weights[static_cast<size_t>((side.edge + 1) % 3)] = static_cast<float>(part);
    return {side.triangle, {weights[1], weights[2]}};
  }

  std::pair<int32_t, int32_t> vertices(TriangleEdge side) const {
    const int32_t* t = &topology_.triangles[3 * static_cast<size_t>(side.triangle)];
    return std::minmax(t[side.edge], t[(side.edge + 1) % 3]);
  }

  /// Collects open edges where a single surface ends; snow stays where several meet.
  void find_open_edges() {
    std::vector<std::pair<int32_t, int32_t>> all;
    for (const TriangleEdge& edge : charts_.open_edges) all.push_back(vertices(edge));
    std::sort(all.begin(), all.end());
    for (const TriangleEdge& edge : charts_.open_edges) {
      const auto [first, last] = std::equal_range(all.begin(), all.end(), vertices(edge));
      if (last - first == 1) add_open_edge(edge);
    }
  }

  /// Adds one point per texel along the edge, in the middle of its samples.
  void add_open_edge(TriangleEdge edge) {
    std::vector<std::pair<int32_t, double>> beside;
    const int32_t samples = sample_count(length(edge));
    for (int32_t k = 0; k < samples; ++k) {
      const double part = (k + 0.5) / samples;
      const int32_t texel = texel_beside(edge, part);
      if (texel >= 0) beside.emplace_back(texel, part);
    }
    std::sort(beside.begin(), beside.end());
    for (size_t begin = 0, end = 0; begin < beside.size(); begin = end) {
      double sum = 0.0;
      for (end = begin; end < beside.size() && beside[end].first == beside[begin].first; ++end) {
        sum += beside[end].second;
      }
      const double part = sum / static_cast<double>(end - begin);
      links_.open_edges.push_back({beside[begin].first, point_of(edge, part)});
    }
  }

  int32_t links_on_map(int32_t i) const {
    int32_t count = 0;
    for (int32_t k = 0; k < kForwardLinks; ++k) {
      const int32_t back =
          at(place(i) % resolution_ - kForwardColumn[k], place(i) / resolution_ - kForwardRow[k]);
      count += (is_linked(i, k) ? 1 : 0) + (is_linked(back, k) ? 1 : 0);
    }
    return count;
  }

  void sort_ends() {
    std::vector<ReposeLinks::End> ends;
    const auto across = static_cast<int32_t>(links_.across.size());
    for (int32_t k = 0; k < across; ++k) {
      const ReposeLinks::Across& link = links_.across[static_cast<size_t>(k)];
      links_.across_cells.push_back({links_.cell_of(place(link.a)), links_.cell_of(place(link.b))});
      ends.push_back({link.a, links_.across_cells.back()[0], k, -1, 0});
      ends.push_back({link.b, links_.across_cells.back()[1], k, 1, 0});
    }
    for (size_t k = 0; k < links_.open_edges.size(); ++k) {
      ends.push_back({links_.open_edges[k].texel, links_.cell_of(place(links_.open_edges[k].texel)),
                      across + static_cast<int32_t>(k), -1, 0});
    }
    std::sort(ends.begin(), ends.end(), [](const auto& a, const auto& b) {
      return std::pair(a.texel, a.link) < std::pair(b.texel, b.link);
    });
    for (size_t begin = 0, end = 0; begin < ends.size(); begin = end) {
      while (end < ends.size() && ends[end].texel == ends[begin].texel) ++end;
      const int32_t count = links_on_map(ends[begin].texel) + static_cast<int32_t>(end - begin);
      for (size_t e = begin; e < end; ++e) ends[e].links = count;
    }
    const auto side = static_cast<size_t>(links_.blocks_a_side);
    const auto for_ends = [&](const auto& visit) {
      for (const ReposeLinks::End& end : ends) visit(end.cell / kTileCells, end);
    };
    base::group_by_key(side * side, for_ends, links_.end_begin, links_.ends);
  }

  void find_near_blocks() {
    const int32_t side = links_.blocks_a_side;
    std::vector<std::pair<int32_t, int32_t>> pairs;
    for (int32_t row = 0; row < side; ++row) {
      for (int32_t column = 0; column < side; ++column) {
        for (int32_t y = std::max(0, row - 1); y <= std::min(side - 1, row + 1); ++y) {
          for (int32_t x = std::max(0, column - 1); x <= std::min(side - 1, column + 1); ++x) {
            pairs.emplace_back(row * side + column, y * side + x);
          }
        }
      }
    }
    for (const ReposeLinks::Across& link : links_.across) {
      const int32_t a = links_.block_of(place(link.a));
      const int32_t b = links_.block_of(place(link.b));
      pairs.emplace_back(a, b);
      pairs.emplace_back(b, a);
    }
    std::vector<uint8_t> has_texels(links_.block_count(), 0);
    for_each_place(table_, [&](int32_t, int32_t column, int32_t row) {
      has_texels[static_cast<size_t>(links_.cell_at(column, row) / kTileCells)] = 1;
    });
    std::erase_if(pairs, [&](const auto& pair) {
      return has_texels[static_cast<size_t>(pair.first)] == 0 ||
             has_texels[static_cast<size_t>(pair.second)] == 0;
    });
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    const auto for_pairs = [&](const auto& visit) {
      for (const auto& [block, other] : pairs) visit(block, other);
    };
    base::group_by_key(links_.block_count(), for_pairs, links_.near_begin, links_.near);
  }

  const MapTopology& topology_;
  const TexelTable& table_;
  const Charts charts_;
  int32_t resolution_;
  /// Per place of the map: its texel, or -1.
  std::vector<int32_t> owned_;
  /// Per texel: its links to the forward neighbours.
  std::vector<uint8_t> forward_;
  ReposeLinks links_;
};

}  // namespace

ReposeLinks find_repose_links(const MapTopology& topology, const TexelTable& table,
                              const std::vector<glm::vec3>& positions) {
  return LinkFinder(merge_vertices(topology, positions), table).find();
}

struct ReposeLinkTables::Known {
  MapTopology merged;
  std::once_flag once;
  std::shared_ptr<const ReposeLinks> links;
};

std::shared_ptr<const ReposeLinks> ReposeLinkTables::find(
    const MapTopology& topology, const std::shared_ptr<const TexelTable>& table,
    const std::vector<glm::vec3>& positions) {
  // Nobody shares it.
  if (table.use_count() == 1) {
    return std::make_shared<const ReposeLinks>(find_repose_links(topology, *table, positions));
  }
  MapTopology own = merge_vertices(topology, positions);
  std::shared_ptr<Known> known;
  {
    const std::scoped_lock lock(mutex_);
    std::vector<std::shared_ptr<Known>>& all = known_[table.get()];
    const auto equal = std::find_if(all.begin(), all.end(), [&](const auto& one) {
      return one->merged.triangles == own.triangles;
    });
    if (equal != all.end()) {
      known = *equal;
    } else {
      known = std::make_shared<Known>();
      known->merged = std::move(own);
      all.push_back(known);
    }
  }
  std::call_once(known->once, [&] {
    known->links = std::make_shared<const ReposeLinks>(LinkFinder(known->merged, *table).find());
  });
  return known->links;
}

}  // namespace snowbough::snow
