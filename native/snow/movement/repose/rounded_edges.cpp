#include "snow/movement/repose/rounded_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "shaders/lib/texel_repose.h"

namespace snowbough::snow {
namespace {

/// Cells that are less steep than this, by the upward part of their normals, end in a sharp edge.
constexpr float kLevel = 0.98f;
/// The height of a rounding is between these parts of the way from the outlet to the surface inland
/// of it. That surface falls inland by less than the third part of the way, and the tangent of its
/// slope changes by less than the fourth. Balls and logs have no such surface.
constexpr float kLeastRounding = 0.05f;
constexpr float kMostRounding = 1.0f / 3.0f;
constexpr float kFallsInland = 0.1f;
constexpr float kBends = 0.1f;
/// Tangent of the steepest surface inland.
constexpr double kSteepestInland = 2.5;
/// A rounding whose curvature is known ends within this many of its radii; a twig is narrower.
constexpr float kRadii = 2.0f;
/// Factor between the ways that are searched. The middle of each is compared with its end.
constexpr float kNextInland = std::numbers::sqrt2_v<float>;
/// Snow this many times as deep as a rounding is high lies over it as over a sharp edge; snow that
/// is less deep by the rounding's height lies on it.
constexpr float kDepthsOfRounding = 3.0f;
/// Searches on for the surface inland of a rounding, up to `widest` metres. The distances do not
/// depend on where earlier searches ended.
void find_edge(ReposeGround& ground, const Outlet& outlet, float curvature, float widest,
               RoundedEdge& edge) {
  const auto outlet_z = static_cast<float>(outlet.point.z);
  // Beyond the rounding nothing is steep, so that a ray that meets nothing is not within the body.
  const double most = curvature > 0.0f ? 1.0 : std::numeric_limits<double>::infinity();
  bool is_steep = false;
  const auto inland = [&](float distance) {
    const double way = static_cast<double>(distance);
    const double over = kSteepestInland * way;
    const glm::dvec3 from = outlet.point + glm::dvec3(-way * outlet.outwards, over);
    const glm::dvec3 down(0.0, 0.0, -1.0);
    const RayHit hit = ground.own_rays.hit_at(
        ground.own_rays.first_along(from, down, 0.0, most * over), 0, from, down);
    is_steep = is_steep || hit.is_inside(true);
    if (hit.object < 0 || !holds_snow(hit) || hit.distance >= over) return MapPoint{};
    MapPoint point = map_point(*ground.object, hit, from.z - hit.distance);
    // Of the face: that of the texel depends on where the object stands, by rounding.
    if (point.column > 0.0f) {
      point.column = shared::column_height(static_cast<float>(std::abs(hit.up)));
    }
    return point;
  };
  if (edge.searched == 0.0f) {
    const auto reach = static_cast<float>(outlet.reach);
    edge.searched = curvature * reach > 0.0f ? std::max(reach, kRadii / curvature) : reach;
  }
  while (edge.height == 0.0f && kNextInland * edge.searched <= widest) {
    edge.searched *= kNextInland;
    is_steep = false;
    const MapPoint far = inland(edge.searched);
    const MapPoint near = far.object >= 0 ? inland(0.5f * edge.searched) : far;
    // Rays from within the body.
    if (is_steep) continue;
    const float rise = far.z - near.z;
    if (near.object < 0 || rise < -kFallsInland * edge.searched) {
      edge.searched = std::numeric_limits<float>::infinity();
      return;
    }
    // Where the surface would end if it went on outwards as it does from one to the other.
    const float height = near.z - std::max(rise, 0.0f) - outlet_z;
    const float slope = shared::bare_slope(1.0f / std::max(far.column, 1.0f));
    const bool goes_on = std::abs(2.0f * std::abs(rise) / edge.searched - slope) < kBends;
    if (goes_on && height > kLeastRounding * edge.searched &&
        height < kMostRounding * edge.searched) {
      edge.height = height;
      edge.inland = far;
    }
  }
}

}  // namespace

void raise_rounded_edges(ReposeGround& ground, float deepest, int32_t block,
                         const std::vector<float>& height, ReposeBlocks& map) {
  std::map<int32_t, RoundedEdge>& known = ground.edges[static_cast<size_t>(block)];
  const ReposeTile& tile = *map.tiles[static_cast<size_t>(block)];
  const float widest = deepest / (kMostRounding * (kDepthsOfRounding - 1.0f));
  int32_t cell = -1;
  float top = 0.0f;
  for (OutletLink& outlet : map.outlet_links[static_cast<size_t>(block)]) {
    // Sheets end in open edges without walls below.
    const bool is_at_wall = outlet.number < static_cast<int32_t>(ground.links->across.size());
    const float up = std::abs(tile.ground.up[static_cast<size_t>(outlet.cell)]);
    if (!(outlet.limit < kNoLink) || !is_at_wall || up > kLevel) continue;
    if (outlet.cell != cell) {
      cell = outlet.cell;
      top = -shared::kUnbounded;
      RoundedEdge& edge = known[cell];
      if (edge.height == 0.0f && kNextInland * edge.searched <= widest) {
        find_edge(ground, outlet_of(ground, outlet, ground.pose.positions()),
                  tile.ground.curvature[static_cast<size_t>(cell)], widest, edge);
      }
      if (edge.height == 0.0f || edge.searched > widest) continue;
      const float depth =
          edge.inland.place < 0
              ? 0.0f
              : std::abs(height[static_cast<size_t>(edge.inland.place)]) * edge.inland.column;
      const float part = std::clamp(depth / edge.height - (kDepthsOfRounding - 1.0f), 0.0f, 1.0f);
      if (part > 0.0f) top = outlet.bare + outlet.rise + part * edge.height;
    }
    outlet.top = std::max(outlet.top, top);
  }
}

}  // namespace snowbough::snow
