#include "snow/surface/cushions.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "base/parallel_for.h"
#include "base/union_find.h"
#include "snow/surface/cell_grid.h"

namespace snowbough::snow {
namespace {

/// Radius of the dilation as a fraction of the snow depth, and its bounds in metres.
constexpr float kRadius = 0.35f;
constexpr float kMinRadius = 0.001f;
constexpr float kMaxRadius = 0.02f;
/// As fractions of the radius: least half-thickness of a body; depth of the final surface below
/// that of the dilated snow; height of a second layer above the snow, which makes a flat spray as
/// thick as a body.
constexpr float kCore = 1.02f;
constexpr float kSurface = 0.6f;
constexpr float kRaised = 0.75f;
constexpr float kCellsPerRadius = 2.5f;
/// Greatest size of a cell as a fraction of the radius.
constexpr float kCoarsest = 0.7f;
/// Snow thinner than this fraction of the depth does not bridge gaps.
constexpr float kThinnest = 0.02f;
/// Limit on the number of cells; a larger grid gets larger cells.
constexpr double kMaxCells = 6e7;

/// Criteria for needles: the least number of pieces, and the fraction of pieces that exceed this
/// ratio of length to width and are narrower than this fraction of the depth.
constexpr size_t kMinPieces = 50;
constexpr double kMostly = 0.6;
constexpr float kLengthToWidth = 4.0f;
constexpr float kWidthOfDepth = 0.5f;

/// Values on a regular grid in space.
class Grid {
 public:
  Grid(const glm::vec3& low, const glm::vec3& high, float cell)
      : low_(low), cell_(cell), size_(glm::ivec3(glm::ceil((high - low) / cell)) + 1) {}

  glm::ivec3 size() const { return size_; }
  float cell() const { return cell_; }
  size_t count() const {
    return static_cast<size_t>(size_.x) * static_cast<size_t>(size_.y) *
           static_cast<size_t>(size_.z);
  }
  size_t index(const glm::ivec3& at) const {
    return (static_cast<size_t>(at.z) * size_.y + at.y) * size_.x + at.x;
  }
  glm::vec3 place(const glm::vec3& at) const { return low_ + at * cell_; }
  glm::vec3 cells(const glm::vec3& point) const { return (point - low_) / cell_; }

 private:
  glm::vec3 low_;
  float cell_;
  glm::ivec3 size_;
};

/// The rows of a grid, by y and z, that have a value over 0 or a neighbour that has one. The other
/// rows are skipped.
class OccupiedRows {
 public:
  template <typename Value>
  OccupiedRows(const Grid& grid, const std::vector<Value>& values) : size_(grid.size()) {
    const auto rows = static_cast<size_t>(size_.y) * static_cast<size_t>(size_.z);
    std::vector<uint8_t> occupied(rows, 0);
    const auto width = static_cast<size_t>(size_.x);
    base::for_each_item(rows, 256, [&](size_t row) {
      const Value* first = values.data() + row * width;
      occupied[row] =
          std::any_of(first, first + width, [](Value v) { return v > Value(0); }) ? 1 : 0;
    });
    near_.assign(rows, 0);
    for (int z = 0; z < size_.z; ++z) {
      for (int y = 0; y < size_.y; ++y) {
        if (occupied[row(y, z)] == 0) continue;
        for (int dz = std::max(z - 1, 0); dz <= std::min(z + 1, size_.z - 1); ++dz) {
          for (int dy = std::max(y - 1, 0); dy <= std::min(y + 1, size_.y - 1); ++dy) {
            near_[row(dy, dz)] = 1;
          }
        }
      }
    }
  }
  bool has(int y, int z) const { return near_[row(y, z)] != 0; }

 private:
  size_t row(int y, int z) const { return static_cast<size_t>(z) * size_.y + y; }

  glm::ivec3 size_;
  std::vector<uint8_t> near_;
};

/// Grid offsets within a radius, with their lengths.
struct Ball {
  std::vector<glm::ivec3> step;
  std::vector<float> length;
};

Ball ball(float cells) {
  Ball found;
  const int reach = static_cast<int>(std::ceil(cells));
  for (int z = -reach; z <= reach; ++z) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        const float length = glm::length(glm::vec3(x, y, z));
        if (length <= cells) {
          found.step.emplace_back(x, y, z);
          found.length.push_back(length);
        }
      }
    }
  }
  return found;
}

/// Samples of the snow: its points, and positions along the edges between them.
std::vector<glm::vec3> snow_places(const SurfaceMesh& mesh, const std::vector<glm::vec3>& shown,
                                   const std::vector<float>& height, float least, float spacing) {
  std::vector<glm::vec3> places;
  for (size_t p = 0; p < shown.size(); ++p) {
    if (height[p] > least) places.push_back(shown[p]);
  }
  for (const auto& [a, b] : surface_edges(mesh.triangle).ends) {
    if (height[a] <= least || height[b] <= least) continue;
    const auto parts = static_cast<int>(glm::distance(shown[a], shown[b]) / spacing);
    for (int k = 1; k < parts; ++k) {
      places.push_back(
          glm::mix(shown[a], shown[b], static_cast<float>(k) / static_cast<float>(parts)));
    }
  }
  return places;
}

/// For each cell, the distance in cells to the nearest cell that is farther than `radius` from all
/// places, at most `most`; 0 outside the dilated snow.
std::vector<float> depth_in_grown(const Grid& grid, const std::vector<glm::vec3>& places,
                                  float radius, float most) {
  std::vector<uint8_t> grown(grid.count(), 0);
  const float reach = radius / grid.cell();
  for (const glm::vec3& place : places) {
    const glm::vec3 at = grid.cells(place);
    const glm::ivec3 low = glm::max(glm::ivec3(glm::ceil(at - reach)), 0);
    const glm::ivec3 high = glm::min(glm::ivec3(glm::floor(at + reach)), grid.size() - 1);
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
          if (glm::distance(glm::vec3(x, y, z), at) <= reach) grown[grid.index({x, y, z})] = 1;
        }
      }
    }
  }
  const Ball around = ball(most);
  const OccupiedRows rows(grid, grown);
  std::vector<float> depth(grid.count(), 0.0f);
  const glm::ivec3 size = grid.size();
  base::for_each_item(static_cast<size_t>(size.z), 1, [&](size_t slice) {
    const auto z = static_cast<int>(slice);
    for (int y = 0; y < size.y; ++y) {
      if (!rows.has(y, z)) continue;
      for (int x = 0; x < size.x; ++x) {
        const size_t here = grid.index({x, y, z});
        if (grown[here] == 0) continue;
        float nearest = most;
        for (size_t i = 0; i < around.step.size(); ++i) {
          if (around.length[i] >= nearest) continue;
          const glm::ivec3 at = glm::ivec3(x, y, z) + around.step[i];
          const bool outside = glm::any(glm::lessThan(at, glm::ivec3(0))) ||
                               glm::any(glm::greaterThanEqual(at, size));
          if (outside || grown[grid.index(at)] == 0) nearest = around.length[i];
        }
        // The border lies half a cell before the nearest cell outside.
        depth[here] = nearest - 0.5f;
      }
    }
  });
  return depth;
}

/// Keeps only depths within `reach` cells of a cell deeper than `core`; sets the others to 0.
void open_bodies(const Grid& grid, std::vector<float>& depth, float core, float reach) {
  const Ball around = ball(reach);
  const OccupiedRows rows(grid, depth);
  std::vector<uint8_t> near(depth.size(), 0);
  const glm::ivec3 size = grid.size();
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      if (!rows.has(y, z)) continue;
      for (int x = 0; x < size.x; ++x) {
        if (depth[grid.index({x, y, z})] < core) continue;
        for (const glm::ivec3& step : around.step) {
          const glm::ivec3 at = glm::ivec3(x, y, z) + step;
          if (glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) &&
              glm::all(glm::lessThan(at, size))) {
            near[grid.index(at)] = 1;
          }
        }
      }
    }
  }
  for (size_t i = 0; i < depth.size(); ++i) {
    if (near[i] == 0) depth[i] = 0.0f;
  }
}

/// Averages each value with its neighbours, one axis after the other.
void blur(const Grid& grid, std::vector<float>& values) {
  const glm::ivec3 size = grid.size();
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<float> before = values;
    const OccupiedRows rows(grid, before);
    glm::ivec3 step(0);
    step[axis] = 1;
    base::for_each_item(static_cast<size_t>(size.z), 1, [&](size_t slice) {
      const auto z = static_cast<int>(slice);
      for (int y = 0; y < size.y; ++y) {
        if (!rows.has(y, z)) continue;
        for (int x = 0; x < size.x; ++x) {
          const glm::ivec3 at(x, y, z);
          if (at[axis] == 0 || at[axis] + 1 == size[axis]) continue;
          values[grid.index(at)] =
              0.25f * (before[grid.index(at - step)] + before[grid.index(at + step)]) +
              0.5f * before[grid.index(at)];
        }
      }
    });
  }
}

struct Net {
  std::vector<glm::vec3> point;
  std::vector<std::array<int32_t, 4>> quads;
};

/// The isosurface at the value `of`. Each cube of eight cells that the surface crosses has one
/// point, at the mean of the crossings on the cube's edges. Each crossed edge has one quad.
Net surface_net(const Grid& grid, const std::vector<float>& values, float of) {
  Net net;
  const glm::ivec3 size = grid.size();
  const OccupiedRows rows(grid, values);
  std::vector<int32_t> number(grid.count(), -1);
  const auto value = [&](const glm::ivec3& at) { return values[grid.index(at)] - of; };
  for (int z = 0; z + 1 < size.z; ++z) {
    for (int y = 0; y + 1 < size.y; ++y) {
      if (!rows.has(y, z)) continue;
      for (int x = 0; x + 1 < size.x; ++x) {
        const glm::ivec3 corner(x, y, z);
        glm::vec3 sum(0.0f);
        int crossings = 0;
        for (int axis = 0; axis < 3; ++axis) {
          for (int k = 0; k < 4; ++k) {
            glm::ivec3 from = corner;
            from[(axis + 1) % 3] += k & 1;
            from[(axis + 2) % 3] += k >> 1;
            glm::ivec3 to = from;
            ++to[axis];
            const float a = value(from);
            const float b = value(to);
            if ((a > 0.0f) == (b > 0.0f)) continue;
            sum += glm::mix(glm::vec3(from), glm::vec3(to), a / (a - b));
            ++crossings;
          }
        }
        if (crossings == 0) continue;
        number[grid.index(corner)] = static_cast<int32_t>(net.point.size());
        net.point.push_back(grid.place(sum / static_cast<float>(crossings)));
      }
    }
  }
  for (int z = 1; z + 1 < size.z; ++z) {
    for (int y = 1; y + 1 < size.y; ++y) {
      if (!rows.has(y, z)) continue;
      for (int x = 1; x + 1 < size.x; ++x) {
        const glm::ivec3 from(x, y, z);
        for (int axis = 0; axis < 3; ++axis) {
          glm::ivec3 to = from;
          ++to[axis];
          const bool inside = value(from) > 0.0f;
          if (inside == (value(to) > 0.0f)) continue;
          glm::ivec3 across(0);
          across[(axis + 1) % 3] = 1;
          glm::ivec3 up(0);
          up[(axis + 2) % 3] = 1;
          std::array<int32_t, 4> quad{number[grid.index(from - across - up)],
                                      number[grid.index(from - up)], number[grid.index(from)],
                                      number[grid.index(from - across)]};
          if (!inside) std::reverse(quad.begin(), quad.end());
          net.quads.push_back(quad);
        }
      }
    }
  }
  return net;
}

void relax(Net& net, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    std::vector<glm::vec3> sum(net.point.size(), glm::vec3(0.0f));
    std::vector<float> count(net.point.size(), 0.0f);
    for (const auto& quad : net.quads) {
      for (size_t k = 0; k < 4; ++k) {
        sum[quad[k]] += net.point[quad[(k + 1) % 4]] + net.point[quad[(k + 3) % 4]];
        count[quad[k]] += 2.0f;
      }
    }
    for (size_t p = 0; p < net.point.size(); ++p) {
      if (count[p] > 0.0f) net.point[p] = glm::mix(net.point[p], sum[p] / count[p], 0.5f);
    }
  }
}

/// The net of cushions of a radius, with cells of at least `cell` metres. Empty if the cells would
/// be too coarse for any shape.
Net cushion_net(std::vector<glm::vec3> places, float radius, float& cell) {
  glm::vec3 low = places.front();
  glm::vec3 high = places.front();
  for (const glm::vec3& place : places) {
    low = glm::min(low, place);
    high = glm::max(high, place);
  }
  const size_t count = places.size();
  for (size_t i = 0; i < count; ++i) {
    places.push_back(places[i] + glm::vec3(0.0f, 0.0f, kRaised * radius));
  }
  low -= 1.5f * radius;
  high += 2.5f * radius;
  const glm::dvec3 extent(high - low);
  cell = std::max(cell, static_cast<float>(std::cbrt(extent.x * extent.y * extent.z / kMaxCells)));
  if (cell > kCoarsest * radius) return {};
  const Grid grid(low, high, cell);
  const float cells = radius / cell;
  std::vector<float> inside = depth_in_grown(grid, places, radius, kCore * cells + 1.5f);
  open_bodies(grid, inside, kCore * cells, (kCore - kSurface) * cells + 0.5f);
  blur(grid, inside);
  return surface_net(grid, inside, kSurface * cells);
}

}  // namespace

bool are_needles(const SurfaceMesh& mesh, float depth) {
  base::UnionFind joined(mesh.position.size());
  for (const auto& [a, b, c] : mesh.triangle) joined.join(joined.join(a, b), c);
  const std::vector<int32_t> part = std::move(joined).all();
  struct Piece {
    glm::vec3 low{std::numeric_limits<float>::max()};
    glm::vec3 high{-std::numeric_limits<float>::max()};
    float area = 0.0f;
  };
  std::vector<Piece> pieces(mesh.position.size());
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    Piece& piece = pieces[part[mesh.triangle[t][0]]];
    piece.area += 0.5f * glm::length(triangle_cross(mesh, t));
    for (const int32_t p : mesh.triangle[t]) {
      piece.low = glm::min(piece.low, mesh.position[p]);
      piece.high = glm::max(piece.high, mesh.position[p]);
    }
  }
  size_t count = 0;
  size_t thin = 0;
  for (const Piece& piece : pieces) {
    if (!(piece.area > 0.0f)) continue;
    ++count;
    const float length = glm::length(piece.high - piece.low);
    const float width = piece.area / (3.14159f * length);
    if (length > kLengthToWidth * width && width < kWidthOfDepth * depth) ++thin;
  }
  return count >= kMinPieces && static_cast<double>(thin) > kMostly * static_cast<double>(count);
}

Cushions find_cushions(const SurfaceMesh& mesh, const std::vector<glm::vec3>& shown,
                       const std::vector<float>& height, float depth, int32_t most_points) {
  Cushions cushions;
  float radius = std::clamp(kRadius * depth, kMinRadius, kMaxRadius);
  const float least = kThinnest * depth;
  float cell = radius / kCellsPerRadius;
  Net net;
  do {
    const std::vector<glm::vec3> places = snow_places(mesh, shown, height, least, cell);
    if (places.empty()) return cushions;
    net = cushion_net(places, radius, cell);
    // The number of points falls with the square of the cell's size.
    const float ratio =
        std::sqrt(static_cast<float>(net.point.size()) / static_cast<float>(most_points));
    if (net.point.empty()) return cushions;
    if (ratio <= 1.0f) break;
    cell *= 1.05f * ratio;
    radius = std::max(radius, cell / kCoarsest);
    if (radius > depth) return cushions;
  } while (true);
  relax(net, 3);

  std::vector<CellGrid::Box> boxes;
  std::vector<int32_t> snowy;
  for (size_t p = 0; p < shown.size(); ++p) {
    if (height[p] <= least) continue;
    boxes.push_back({shown[p], shown[p]});
    snowy.push_back(static_cast<int32_t>(p));
  }
  const CellGrid near(boxes, radius);
  cushions.anchor.assign(net.point.size(), snowy.front());
  cushions.offset.resize(net.point.size());
  base::for_each_item(net.point.size(), 64, [&](size_t p) {
    float best = std::numeric_limits<float>::max();
    for (float reach = radius; reach < 8.0f * radius; reach *= 2.0f) {
      near.visit(net.point[p] - reach, net.point[p] + reach, [&](int32_t i) {
        const float distance = glm::distance(shown[snowy[i]], net.point[p]);
        if (distance < best || (distance == best && snowy[i] < cushions.anchor[p])) {
          best = distance;
          cushions.anchor[p] = snowy[i];
        }
      });
      if (best < reach) break;
    }
    cushions.offset[p] = net.point[p] - shown[cushions.anchor[p]];
  });
  cushions.quads = std::move(net.quads);
  return cushions;
}

}  // namespace snowbough::snow
