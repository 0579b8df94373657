#include "snow/surface/blanket.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <tuple>

#include "base/parallel_for.h"
#include "shaders/lib/snow_surface.h"
#include "snow/surface/vectors.h"

namespace snowbough::snow {
namespace {

using shared::eased;

// Lengths are fractions of the snow depth on open ground unless stated otherwise.
/// Size of the cells whose points make a node.
constexpr float kCell = 0.3f;
/// A plane fits the nodes around it with weights that fall off over the first distance, up to the
/// second. A member takes the planes of the nodes around it likewise.
constexpr float kPlane = 0.4f;
constexpr float kPlaneReach = 0.8f;
constexpr float kNear = 0.25f;
constexpr float kNearReach = 0.5f;
/// Nodes that lie farther from the plane through the receiver than the first distance count less,
/// those farther than the second not at all.
constexpr float kOneGround = 0.5f;
constexpr float kOtherGround = 0.8f;
/// Least upward component of the normals of points that snow can lie on.
constexpr float kMinUp = 0.3f;
/// Cosines of the angle to the blanket at which a face bears it not at all and fully.
constexpr float kLeans = 0.6f;
constexpr float kBears = 0.85f;
/// Upward component of the normals of faces that carry a blanket.
constexpr float kCarries = 0.6f;
/// Depths below the ground around, in depths of snow, from which on a blanket leaves a joint's bed
/// alone, and up to which it covers one.
constexpr float kDeep = 0.8f;
constexpr float kShallow = 0.4f;
/// Mean height of the snow above the ground, in steps, that leaves a step as it is, and that hides
/// it.
constexpr float kBareStep = 0.75f;
constexpr float kHiddenStep = 1.75f;

/// Greatest thickness at a rim in shelter, as a multiple of that off the rim.
constexpr float kMostOfOff = 1.5f;

/// Greatest distance of a foot outwards from the rim and inwards below it.
constexpr float kFootOut = 0.45f;
constexpr float kFootUnder = 0.3f;
/// Distance from the rim at which the snow is not lower because of the step.
constexpr float kOffFoot = 0.5f;
/// Faces need points up to this distance inwards below the rim.
constexpr float kSeenUnder = 0.06f;
/// Slope of the snow that goes on below the upper piece.
constexpr float kTuckedSlope = 0.35f;
/// Least upward component of the normal of a face at a foot.
constexpr float kFootCarries = 0.3f;

/// The plane z = x * level.x + y * level.y + z of weighted places, relative to a centre; it is
/// level in directions in which there are too few.
struct Fit {
  glm::mat3 square{0.0f};
  void add(const glm::vec3& row, float weight) { square += glm::outerProduct(row, row) * weight; }
  glm::mat3 inverse(float reach) const {
    // Few nodes in a row give no slope across it.
    const float least = 0.02f * square[2][2] * reach * reach;
    glm::mat3 whole = square;
    whole[0][0] += least;
    whole[1][1] += least;
    whole[2][2] += 1e-12f;
    return glm::inverse(whole);
  }
};

float falling(float distance, float over) {
  return std::exp(-distance * distance / (over * over));
}

}  // namespace

void Blanket::find_nodes(const SurfacePoints& points, const std::vector<int32_t>& lying,
                         const std::vector<float>& area, float depth) {
  const std::vector<glm::vec3>& position = points.mesh.position;
  // The points of a cell, in the order of the cells.
  struct Placed {
    glm::vec3 cell;  // whole numbers, however far from the origin
    int32_t point;
  };
  std::vector<Placed> placed;
  for (const int32_t p : lying) {
    placed.push_back({glm::floor(position[p] / (kCell * depth)), p});
  }
  const auto key = [](const Placed& one) {
    return std::tuple(one.cell.x, one.cell.y, one.cell.z, one.point);
  };
  std::sort(placed.begin(), placed.end(),
            [&](const Placed& a, const Placed& b) { return key(a) < key(b); });
  share_begin_.push_back(0);
  for (size_t i = 0; i < placed.size();) {
    Node node;
    const size_t first = i;
    for (; i < placed.size() && placed[i].cell == placed[first].cell; ++i) {
      const int32_t p = placed[i].point;
      const float covers = area[p] * points.normal[p].z + 1e-9f * depth * depth;
      node.centre += position[p] * covers;
      node.area += covers;
      shares_.push_back({p, covers / std::max(points.normal[p].z, kMinUp)});
    }
    node.centre /= node.area;
    for (size_t s = first; s < i; ++s) shares_[s].weight /= node.area;
    share_begin_.push_back(static_cast<int32_t>(shares_.size()));
    nodes_.push_back(node);
  }
}

CellGrid Blanket::node_grid() const {
  std::vector<CellGrid::Box> boxes;
  for (const Node& node : nodes_) boxes.push_back({node.centre, node.centre});
  return {boxes, kPlaneReach * depth_};
}

template <typename Visit>
void Blanket::visit_nodes(const CellGrid& grid, const glm::vec3& place, float reach,
                          const Visit& visit) const {
  grid.visit(place - reach, place + reach, [&](int32_t n) {
    const float distance = glm::distance(nodes_[n].centre, place);
    if (distance < reach) visit(n, nodes_[n], place - nodes_[n].centre, distance);
  });
}

float Blanket::on_ground_of(const Node& node, const glm::vec3& from_centre, float depth) {
  const float off =
      std::abs(from_centre.z - node.ground.x * from_centre.x - node.ground.y * from_centre.y);
  return eased(off, kOtherGround * depth, kOneGround * depth);
}

void Blanket::fit_ground(const CellGrid& grid, float depth) {
  const float reach = kPlaneReach * depth;
  base::for_each_item(nodes_.size(), 16, [&](size_t n) {
    Fit fit;
    glm::vec3 sum(0.0f);
    visit_nodes(grid, nodes_[n].centre, reach,
                [&](int32_t, const Node& node, const glm::vec3& from_centre, float distance) {
                  const glm::vec3 row(-from_centre.x, -from_centre.y, 1.0f);
                  const float weight = node.area * falling(distance, kPlane * depth);
                  fit.add(row, weight);
                  sum += row * (weight * -from_centre.z);
                });
    nodes_[n].ground = fit.inverse(reach) * sum;
  });
}

void Blanket::find_plane_parts(const CellGrid& grid, float depth) {
  const float reach = kPlaneReach * depth;
  std::vector<std::vector<PlanePart>> parts(nodes_.size());
  base::for_each_item(nodes_.size(), 16, [&](size_t n) {
    Fit fit;
    std::vector<PlanePart>& own = parts[n];
    visit_nodes(grid, nodes_[n].centre, reach,
                [&](int32_t m, const Node& node, const glm::vec3& from_centre, float distance) {
                  const float weight = node.area * falling(distance, kPlane * depth) *
                                       on_ground_of(nodes_[n], -from_centre, depth);
                  if (weight <= 0.0f) return;
                  const glm::vec3 row(-from_centre.x, -from_centre.y, 1.0f);
                  fit.add(row, weight);
                  own.push_back({m, row * weight});
                });
    const glm::mat3 inverse = fit.inverse(reach);
    for (PlanePart& one : own) one.part = inverse * one.part;
  });
  part_begin_.push_back(0);
  for (const std::vector<PlanePart>& own : parts) {
    parts_.insert(parts_.end(), own.begin(), own.end());
    part_begin_.push_back(static_cast<int32_t>(parts_.size()));
  }
}

Blanket::Near Blanket::nodes_near(const glm::vec3& place, const CellGrid& grid, float depth) const {
  const float reach = kNearReach * depth;
  Near near;
  visit_nodes(grid, place, reach,
              [&](int32_t n, const Node& node, const glm::vec3& from_centre, float distance) {
                const float weight = node.area * falling(distance, kNear * depth) *
                                     eased(distance, reach, 0.6f * reach) *
                                     on_ground_of(node, from_centre, depth);
                const auto least = std::min_element(near.weight.begin(), near.weight.end());
                if (weight <= *least) return;
                *least = weight;
                near.node[static_cast<size_t>(least - near.weight.begin())] = n;
              });
  float sum = 0.0f;
  for (const float weight : near.weight) sum += weight;
  for (int k = 0; k < kNodes; ++k) {
    if (sum > 0.0f) near.weight[k] /= sum;
    const Node& node = nodes_[near.node[k]];
    const glm::vec3 to = place - node.centre;
    near.ground += near.weight[k] *
                   (node.centre.z + node.ground.z + node.ground.x * to.x + node.ground.y * to.y);
    near.up -= near.weight[k] * glm::vec3(node.ground.x, node.ground.y, 0.0f);
  }
  near.up = unit(near.up);
  return near;
}

Blanket::Blanket(const SurfacePoints& points, const std::vector<int32_t>& lying,
                 const std::vector<float>& area, std::vector<Member> members, float depth)
    : members_(std::move(members)), depth_(depth) {
  if (lying.empty()) members_.clear();  // there is no snow that could go on over them
  if (members_.empty()) return;
  find_nodes(points, lying, area, depth);
  const CellGrid grid = node_grid();
  fit_ground(grid, depth);
  find_plane_parts(grid, depth);
  near_.resize(members_.size());
  base::for_each_item(near_.size(), 64, [&](size_t i) {
    near_[i] = nodes_near(points.mesh.position[members_[i].point], grid, depth);
  });
}

std::vector<glm::vec3> Blanket::planes_on(const std::vector<float>& thickness) const {
  std::vector<float> top(nodes_.size());
  base::for_each_item(top.size(), 256, [&](size_t n) {
    float snow = 0.0f;
    for (int32_t i = share_begin_[n]; i < share_begin_[n + 1]; ++i) {
      snow += shares_[i].weight * thickness[shares_[i].index];
    }
    top[n] = nodes_[n].centre.z + snow;
  });
  std::vector<glm::vec3> planes(nodes_.size());
  base::for_each_item(planes.size(), 64, [&](size_t n) {
    // Relative to the node's own top, for the sake of precision.
    glm::vec3 sum(0.0f);
    for (int32_t i = part_begin_[n]; i < part_begin_[n + 1]; ++i) {
      sum += parts_[i].part * (top[parts_[i].node] - top[n]);
    }
    planes[n] = sum + glm::vec3(0.0f, 0.0f, top[n]);
  });
  return planes;
}

Blanket::Here Blanket::here(const Near& near, const glm::vec3& place,
                            const std::vector<glm::vec3>& planes) const {
  Here here;
  glm::vec3 slope(0.0f, 0.0f, 1.0f);
  for (int k = 0; k < kNodes; ++k) {
    const float weight = near.weight[k];
    if (weight <= 0.0f) continue;
    const auto n = static_cast<size_t>(near.node[k]);
    const glm::vec3 to = place - nodes_[n].centre;
    here.z += weight * (planes[n].z + planes[n].x * to.x + planes[n].y * to.y);
    slope -= weight * glm::vec3(planes[n].x, planes[n].y, 0.0f);
    here.is_found = true;
  }
  here.up = unit(slope);
  return here;
}

void Blanket::aim(const SurfacePoints& points, const std::vector<glm::vec3>& upper,
                  const std::vector<float>& thickness, std::vector<glm::vec3>& normal) {
  const CellGrid grid = node_grid();
  const std::vector<glm::vec3> planes = planes_on(thickness);
  base::for_each_item(members_.size(), 64, [&](size_t i) {
    const Member& member = members_[i];
    const auto p = static_cast<size_t>(member.point);
    // The normals on the bevel of a rim are those of its supporting face.
    const glm::vec3 own = member.front >= 0 && !member.is_far ? normal[p] : upper[p];
    const glm::vec3 up = near_[i].up;
    const float bears = eased(glm::dot(own, up), kLeans, kBears);
    normal[p] = unit(glm::mix(normal[p], glm::mix(up, own, bears), member.foot));
    const glm::vec3& at = points.mesh.position[p];
    const Here blanket = here(near_[i], at, planes);
    const float along = glm::dot(blanket.up, normal[p]);
    if (member.is_far || !blanket.is_found || along < kLeans) return;
    glm::vec3 beside = normal[p] * (std::max(blanket.z - at.z, 0.0f) * blanket.up.z / along);
    beside.z = -(up.x * beside.x + up.y * beside.y) / up.z;
    const Near there = nodes_near(at + beside, grid, depth_);
    if (there.weight[0] <= 0.0f) return;
    near_[i].node = there.node;
    near_[i].weight = there.weight;
  });
}

std::vector<float> Blanket::lay(const SurfacePoints& points, std::vector<float>& goes_on,
                                std::vector<glm::vec3>& ups, std::vector<float>& thickness) const {
  std::vector<float> shares(thickness.size(), 0.0f);
  std::vector<float> filled = thickness;
  for (const Member& member : members_) {
    if (member.filled <= 0.0f) continue;
    const float share = member.foot > 0.0f ? member.filled : member.filled * goes_on[member.front];
    const float own = thickness[member.point];
    filled[member.point] = glm::mix(own, std::max(own, member.off.of(thickness)), share);
  }
  const std::vector<glm::vec3> planes = planes_on(filled);
  std::vector<float> of_front(goes_on.size(), 0.0f);
  base::for_each_item(members_.size(), 256, [&](size_t i) {
    const Member& member = members_[i];
    const auto p = static_cast<size_t>(member.point);
    const glm::vec3& at = points.mesh.position[p];
    const Here blanket = here(near_[i], at, planes);
    if (!blanket.is_found) return;
    const float step = std::max(member.step, 1e-4f);
    const float hides = eased(blanket.z - near_[i].ground, kBareStep * step, kHiddenStep * step);
    const glm::vec3& up = blanket.up;
    const float along = glm::dot(up, points.normal[p]);
    // Along the normal of a steep side, the way to the blanket would be long and end beside it.
    const float level = eased(points.normal[p].z, shared::kSteep, kCarries);
    // A level face bears a blanket however steep it is, but below the upper piece such a blanket
    // would stand out of the snow on that.
    const auto bears = [&](float cosine) {
      return member.is_far ? 1.0f
                           : eased(cosine, kLeans, kBears) * level *
                                 eased(near_[i].ground - at.z, kDeep * depth_, kShallow * depth_);
    };
    float share = member.foot * hides * bears(along);
    if (member.front >= 0) {
      of_front[member.front] = goes_on[member.front] * hides * bears(along / up.z);
      ups[member.front] = up;
      share = std::max(share, of_front[member.front]);
    }
    shares[p] = share;
    if (share <= 0.0f || member.is_far) return;
    float thick = std::max((blanket.z - at.z) * up.z / along - member.tucked, 0.0f);
    // On a ledge below a piece, a blanket over both would be a spire.
    if (member.in_shelter) thick = std::min(thick, kMostOfOff * member.off.of(filled));
    thickness[p] = glm::mix(thickness[p], thick, share);
  });
  goes_on = std::move(of_front);
  return shares;
}

float filled_behind(float distance, float depth) {
  return eased(distance, kFootOut * depth, 0.6f * kFootOut * depth);
}

bool is_at_foot(const Rims& rims, const glm::vec3& point, const glm::vec3& normal, float depth) {
  if (normal.z < kFootCarries) return false;
  const Rims::Step step = rims.step_above(point, normal, kFootOut * depth, depth);
  return step.height > 0.0f && step.out > -kSeenUnder * depth;
}

std::vector<Blanket::Member> find_feet(const std::vector<glm::vec3>& position,
                                       const std::vector<glm::vec3>& normal, const Rims& rims,
                                       const NearestPoints& lying, float depth) {
  const std::vector<int32_t>& all = lying.chosen();
  std::vector<Blanket::Member> found(all.size());
  base::for_each_item(all.size(), 64, [&](size_t i) {
    const int32_t p = all[i];
    const Rims::Step step = rims.step_above(position[p], normal[p], kFootOut * depth, depth);
    if (step.height <= 0.0f) return;
    // Below the upper piece: where the snow of the point, which grows along its normal, passes the
    // rim.
    const float leans = std::max(glm::dot(normal[p], step.level_out), 0.0f) / normal[p].z;
    const float out = std::max(step.out, std::min(step.out + step.height * leans, 0.0f));
    if (out < -kFootUnder * depth) return;
    Blanket::Member& foot = found[i];
    foot.point = p;
    foot.step = step.height;
    const glm::vec3 off = step.foot + step.level_out * (kOffFoot * depth);
    const glm::vec3 place = off - normal[p] * glm::dot(off - position[p], normal[p]);
    foot.off = lying.at(place, p, kOffFoot * depth, false);
    foot.tucked = kTuckedSlope * std::max(-out, 0.0f);
    foot.foot =
        filled_behind(out, depth) * eased(out, -kFootUnder * depth, -0.5f * kFootUnder * depth);
  });
  for (Blanket::Member& foot : found) foot.filled = foot.foot;
  std::erase_if(found, [](const Blanket::Member& foot) { return foot.foot <= 0.0f; });
  return found;
}

}  // namespace snowbough::snow
