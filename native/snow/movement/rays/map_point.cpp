#include "snow/movement/rays/map_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "shaders/lib/texel_repose.h"

namespace snowbough::snow {
namespace {

/// Whether a texel has a fragment of a triangle.
bool shows(const TexelTable& table, int32_t texel, int32_t triangle) {
  const auto i = static_cast<size_t>(texel);
  const auto begin = table.fragment_triangle.begin() + table.fragment_begin[i];
  const auto end = table.fragment_triangle.begin() + table.fragment_begin[i + 1];
  return std::find(begin, end, triangle) != end;
}

/// The place of the texel with a fragment of a triangle nearest to a point on the map, in columns
/// and rows; -1: none is near.
int32_t place_near(const TexelTable& table, int32_t triangle, glm::vec2 at) {
  const auto column = static_cast<int32_t>(std::floor(at.x));
  const auto row = static_cast<int32_t>(std::floor(at.y));
  const int32_t last = table.resolution - 1;
  int32_t nearest = -1;
  float least = 1e30f;
  auto found = table.texel.begin();
  for (int32_t y = std::max(0, row - 1); y <= std::min(last, row + 1); ++y) {
    const int32_t first = y * table.resolution + std::max(0, column - 1);
    const int32_t end = y * table.resolution + std::min(last, column + 1);
    found = std::lower_bound(found, table.texel.end(), first);
    for (; found != table.texel.end() && *found <= end; ++found) {
      const int32_t place = *found;
      const auto texel = static_cast<int32_t>(found - table.texel.begin());
      if (!shows(table, texel, triangle)) continue;
      const float away_x = static_cast<float>(place % table.resolution) + 0.5f - at.x;
      const float away_y = static_cast<float>(y) + 0.5f - at.y;
      const float distance = away_x * away_x + away_y * away_y;
      if (distance < least) {
        least = distance;
        nearest = place;
      }
    }
  }
  return nearest;
}

}  // namespace

int32_t texel_at(const TexelTable& table, int32_t place) {
  const auto found = std::lower_bound(table.texel.begin(), table.texel.end(), place);
  if (found == table.texel.end() || *found != place) return -1;
  return static_cast<int32_t>(found - table.texel.begin());
}

MapPoint map_point(const SceneObject& object, const RayHit& hit, double z) {
  MapPoint point;
  point.object = hit.object;
  point.z = static_cast<float>(z);
  point.column = shared::column_height(static_cast<float>(std::abs(hit.up)));
  point.is_back = hit.up < 0.0;
  if (!object.description.receive) return point;
  const MapTopology& topology = object.description.topology;
  const glm::vec2* const uv = &topology.corner_uv[3 * static_cast<size_t>(hit.triangle)];
  const glm::vec2 on_map =
      uv[0] + hit.weights.x * (uv[1] - uv[0]) + hit.weights.y * (uv[2] - uv[0]);
  point.place =
      place_near(*object.table, hit.triangle, on_map * static_cast<float>(topology.resolution));
  if (const int32_t texel = texel_at(*object.table, point.place); texel >= 0) {
    // Others of its faces may be walls.
    const auto up = static_cast<float>(
        std::abs(texel_now(object, *object.table, object.positions, texel).normal.z));
    point.column = shared::is_wall(up) ? 0.0f : shared::column_height(up);
  }
  return point;
}

bool holds_snow(const RayHit& hit) {
  return (hit.is_open ? std::abs(hit.up) : hit.up) >= static_cast<double>(shared::kWallUp);
}

RayHit first_ground(const SceneRays& rays, const glm::dvec3& from, const glm::dvec3& direction,
                    double length) {
  // A ray that meets this many walls runs along one.
  constexpr int kMaxWalls = 16;
  double least = 0.0;
  for (int passed = 0; passed < kMaxWalls; ++passed) {
    const RayHit hit = rays.first_along(from, direction, least, length);
    if (hit.object < 0 || holds_snow(hit)) return hit;
    least = hit.distance;
  }
  return {};
}

TexelNow texel_now(const SceneObject& object, const TexelTable& table,
                   const std::vector<glm::vec3>& positions, int32_t texel) {
  const auto corners = [&](int32_t triangle) {
    const int32_t* const own =
        &object.description.topology.triangles[3 * static_cast<size_t>(triangle)];
    const auto corner = [&](int k) { return glm::dvec3(positions[static_cast<size_t>(own[k])]); };
    const glm::dvec3 first = corner(0);
    return std::array{first, corner(1) - first, corner(2) - first};
  };
  const auto i = static_cast<size_t>(texel);
  TexelNow now;
  for (int32_t f = table.fragment_begin[i]; f < table.fragment_begin[i + 1]; ++f) {
    const auto [first, second, third] = corners(table.fragment_triangle[static_cast<size_t>(f)]);
    const glm::dvec3 normal = glm::cross(second, third);
    const double share = static_cast<double>(table.fragment_share[static_cast<size_t>(f)]);
    now.area += 0.5 * share * glm::length(normal);
    now.normal += 0.5 * share * normal;
  }
  if (now.area > 0.0) now.normal /= now.area;
  const auto [first, second, third] = corners(table.triangle[i]);
  const glm::dvec2 weights(table.barycentric[i]);
  now.point = first + weights.x * second + weights.y * third;
  return now;
}

}  // namespace snowbough::snow
