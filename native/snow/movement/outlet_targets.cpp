#include "snow/movement/outlet_targets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/parallel_for.h"
#include "shaders/lib/texel_repose.h"
#include "snow/movement/repose/rounded_edges.h"

namespace snowbough::snow {
namespace {

/// Widest gap in metres that snow can close.
constexpr float kWidestGap = 0.25f;
/// A gap wider than this times the depth of the snow beside it stays open.
constexpr float kDepthsOfGap = 4.0f;
/// Snow up to this many times as thick as a gap is wide has a furrow above it.
constexpr float kArchesToWidths = 3.0f;
/// Factor between the distances at which a gap's far side is searched, and the bisections that
/// follow.
constexpr float kNextDistance = 1.6f;
constexpr int kBisections = 3;
/// Rays onto the snow beside a gap start this many widths above the outlet, which may be below a
/// bevel.
constexpr double kOverBevel = 4.0;
/// Sides that rise higher above an outlet, in metres, are walls.
constexpr double kHighestTop = 1.0;
/// Tops farther below an outlet, in metres, carry no snow that reaches it.
constexpr double kDeepestStep = 1.0;
/// Raises an outlet above all snow.
constexpr float kClosed = 1e6f;
/// Rays start this fraction of the reach above the outlet, so that a surface as high as the outlet
/// is below them.
constexpr double kAbove = 0.5;

/// Vertical height in metres of the top of the snow at a point.
float top_at(const MapPoint& point, const std::vector<const std::vector<float>*>& heights) {
  if (point.place < 0 || heights[static_cast<size_t>(point.object)] == nullptr) return point.z;
  const std::vector<float>& height = *heights[static_cast<size_t>(point.object)];
  return point.z + std::abs(height[static_cast<size_t>(point.place)]) * point.column;
}

}  // namespace

void OutletTargets::lay_out(const std::vector<const SceneObject*>& objects) {
  rays_.lay_out(objects);
  bounds_.assign(objects.size(), {});
  targets_.assign(objects.size(), {});
}

/// Whether rays from an object's outlets may meet something in `moved`, or could before it moved.
bool OutletTargets::is_near(size_t object, const Bounds& moved) const {
  const Bounds& own = bounds_[object];
  return !own.empty() && !moved.empty() && own.low.x - kWidestGap <= moved.high.x &&
         own.high.x + kWidestGap >= moved.low.x && own.low.y - kWidestGap <= moved.high.y &&
         own.high.y + kWidestGap >= moved.low.y;
}

/// The first surface that holds snow straight below a point, from `over` metres above it; walls and
/// undersides of open sheets are passed. Sets `is_closed` if the ray starts within a body.
MapPoint OutletTargets::below(const glm::dvec3& from, double over, bool& is_closed) const {
  const glm::dvec3 start = from + glm::dvec3(0.0, 0.0, over);
  const glm::dvec3 down(0.0, 0.0, -1.0);
  RayHit hit = rays_.first_along(start, down, 0.0);
  is_closed = hit.is_inside(true) && hit.up < -static_cast<double>(shared::kWallUp);
  if (is_closed) return {};
  // A ray that meets this many walls runs along one.
  for (int passed = 0; passed < 16 && hit.object >= 0; ++passed) {
    if (holds_snow(hit)) {
      return map_point(*rays_.objects()[static_cast<size_t>(hit.object)], hit,
                       start.z - hit.distance);
    }
    hit = rays_.first_along(start, down, hit.distance);
  }
  return {};
}

/// Searches on for the far side of a gap, up to about `widest` metres: the first surface that is no
/// farther above or below than away. Before it there may be the top of a step: it rises as steeply
/// from what is below the outlet. The distances do not depend on where earlier searches ended.
void OutletTargets::find_gap(const Outlet& outlet, float widest, OutletTarget& target) const {
  const auto beyond = [&](double distance, double over, bool& is_closed) {
    return below(outlet.point + glm::dvec3(outlet.outwards * distance, 0.0), over, is_closed);
  };
  const auto is_across = [&](double distance) {
    bool is_closed = false;
    const MapPoint point = beyond(distance, distance, is_closed);
    return is_closed || (point.object >= 0 && std::abs(point.z - outlet.point.z) < distance);
  };
  const double bed = target.fall.object >= 0 ? target.fall.z : outlet.point.z - kDeepestStep;
  const auto is_step = [&](double distance) {
    bool is_closed = false;
    const MapPoint point = beyond(distance, distance, is_closed);
    return !is_closed && point.object >= 0 &&
           point.z > std::max(bed + distance, outlet.point.z - kDeepestStep);
  };
  // Where between two distances a condition begins to hold.
  const auto first = [](double last, double distance, const auto& holds) {
    for (int i = 0; i < kBisections; ++i) {
      const double middle = 0.5 * (last + distance);
      (holds(middle) ? distance : last) = middle;
    }
    return distance;
  };
  double width = 0.0;
  while (width == 0.0 && target.searched < widest) {
    const float way = std::min(kNextDistance * target.searched, kWidestGap);
    if (is_across(way)) {
      width = way;
      break;
    }
    if (!(target.step_width > 0.0f) && is_step(way)) {
      bool is_closed = false;
      const double step = first(target.searched, way, is_step);
      target.step = beyond(step, step, is_closed);
      target.step_width = static_cast<float>(step);
    }
    target.searched = way < kWidestGap ? way : std::numeric_limits<float>::infinity();
  }
  if (width == 0.0) return;
  width = first(target.searched, width, is_across);
  target.searched = std::numeric_limits<float>::infinity();
  bool is_closed = false;
  target.far = beyond(width, width, is_closed);
  if (!is_closed && target.far.object < 0) return;
  target.width = static_cast<float>(width);
  // A body that rises more steeply than its distance is the side of a higher top, or a wall,
  // against which snow leans.
  const bool is_side = is_closed;
  target.farther = beyond(2.0 * width, kOverBevel * width, is_closed);
  if (is_closed) target.farther = beyond(2.0 * width, kHighestTop, is_closed);
  target.is_at_wall = is_side && is_closed;
  target.before = beyond(-width, kOverBevel * width, is_closed);
}

OutletTarget OutletTargets::find(const Outlet& outlet) const {
  OutletTarget target;
  target.z = static_cast<float>(outlet.point.z);
  const glm::dvec3 from = outlet.point + glm::dvec3(outlet.outwards * outlet.reach, 0.0);
  target.fall = below(from, kAbove * outlet.reach, target.is_closed);
  if (target.is_closed) {
    target.searched = std::numeric_limits<float>::infinity();
    return target;
  }
  const float drop = static_cast<float>(outlet.point.z) - target.fall.z;
  const auto reach = static_cast<float>(outlet.reach);
  const bool is_over_air = target.fall.object < 0 || drop > reach;
  target.searched = is_over_air && (!outlet.is_wall || is_anything_across(outlet))
                        ? reach
                        : std::numeric_limits<float>::infinity();
  return target;
}

/// Whether anything stands across a gap, or lies below it: round things have many walls, and rarely
/// another one beside them.
bool OutletTargets::is_anything_across(const Outlet& outlet) const {
  const glm::dvec3 out(outlet.outwards, 0.0);
  const glm::dvec3 from = outlet.point + outlet.reach * (out - glm::dvec3(0.0, 0.0, 1.0));
  const glm::dvec3 down = (out - glm::dvec3(0.0, 0.0, 1.0)) / std::numbers::sqrt2;
  const auto widest = static_cast<double>(kWidestGap);
  return rays_.first_along(from, out, 0.0, widest).object >= 0 ||
         rays_.first_along(from, down, 0.0, std::numbers::sqrt2 * widest).object >= 0;
}

void OutletTargets::raise(size_t object, Repose& repose,
                          const std::vector<const std::vector<float>*>& heights) {
  if (repose.choice().chosen.empty()) return;
  std::vector<std::map<int32_t, OutletTarget>>& targets =
      targets_[object][repose.table().resolution];
  targets.resize(repose.blocks().tiles.size());
  const std::vector<int32_t>& blocks = repose.choice().chosen;
  ReposeGround& ground = repose.ground();
  ReposeBlocks& map = repose.blocks();
  const std::vector<float>& highest = repose.choice().highest;
  const float deepest = *std::max_element(highest.begin(), highest.end());
  ground.edges.resize(repose.blocks().tiles.size());
  base::for_each_item(blocks.size(), 1, [&](size_t i) {
    const float widest = kDepthsOfGap * highest_near(*ground.links, repose.choice(), blocks[i]);
    if (widest == 0.0f) return;
    std::map<int32_t, OutletTarget>& known = targets[static_cast<size_t>(blocks[i])];
    for (OutletLink& outlet : map.outlet_links[static_cast<size_t>(blocks[i])]) {
      // Of an earlier step, in which snow lay here.
      outlet.top = outlet.bare;
      if (!(outlet.limit < kNoLink)) continue;
      auto target = known.find(outlet.number);
      const bool is_new = target == known.end();
      if (is_new) {
        if (!is_below_snow(ground, repose.choice().limits, map, blocks[i], outlet)) continue;
        target = known.emplace(outlet.number, find(outlet_of(ground, outlet))).first;
      }
      if (target->second.searched < widest)
        find_gap(outlet_of(ground, outlet), widest, target->second);
      const float above = rise_of(target->second, widest, top_over(map, blocks[i], outlet),
                                  repose.choice().limits.slope, heights);
      // What is known must not depend on earlier steps.
      if (above > 0.0f &&
          (is_new || is_below_snow(ground, repose.choice().limits, map, blocks[i], outlet))) {
        outlet.top = outlet.bare + outlet.rise + above;
      }
    }
    raise_rounded_edges(ground, deepest, blocks[i], *heights[object], map);
  });
}

/// Height in metres of what the snow above an outlet rests against, over the outlet. `near`: the
/// top of that snow; `slope`: tangent of the angle of repose.
float OutletTargets::rise_of(const OutletTarget& target, float widest, float near, float slope,
                             const std::vector<const std::vector<float>*>& heights) {
  float above = target.is_closed ? kClosed : 0.0f;
  const auto over = [&](const MapPoint& point) { return top_at(point, heights) - target.z; };
  if (target.fall.object >= 0) above = std::max(above, over(target.fall));
  if (target.step_width > 0.0f) above = std::max(above, over(target.step) - target.step_width);
  if (!(target.width > 0.0f && target.width <= widest)) return above;
  // The side of a higher top is none itself.
  const MapPoint& top = target.far.object >= 0 ? target.far : target.farther;
  const float next = target.is_at_wall ? kClosed : top.object >= 0 ? over(top) : 0.0f;
  // Snow beside a gap is low because of the gap, so the snow a width away counts, too.
  float far = next;
  if (target.farther.object >= 0) far = std::max(far, over(target.farther));
  if (target.before.object >= 0) near = std::max(near, over(target.before));
  const float least = std::min(near, far);
  const float arch = least - target.width;
  // Deep snow lies over a gap as it lies on one surface.
  const float joined = std::max(arch, std::min(next, near) + shared::kEven * slope * target.width);
  const float part = std::clamp(least / target.width - kArchesToWidths, 0.0f, 1.0f);
  return std::max(above, arch + part * (joined - arch));
}

}  // namespace snowbough::snow
