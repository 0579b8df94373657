#include "tree/surface/limb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "tree/surface/knuckles.h"
#include "tree/surface/stations.h"

namespace snowbough::tree {
namespace {

/// A child thinner than this fraction of a knuckle's side gets an inset.
constexpr double kInsetBelow = 0.9;
/// Minimum fraction of the side that stays around an inset hole, on each edge.
constexpr double kInsetMargin = 0.08;
/// The same along the limb, as a fraction of the free length: the hole moves towards its child, but
/// not up to the knuckle's end, otherwise slivers would remain there that show as dark lines.
constexpr double kFreeMargin = 0.35;
/// A hole shorter along its limb than this fraction of the child's width squeezes the child.
constexpr double kSqueezedBelow = 0.8;
/// Desired gap between knuckles, in corner radii of the limb.
constexpr double kKnuckleGap = 0.3;
/// Minimum cosine of the turn of a child that continues its parent's end ring.
constexpr double kContinuesCosine = -0.3;

class LimbBuilder {
 public:
  LimbBuilder(const LimbPlan& plan, int32_t branch, const std::vector<uint8_t>& narrowing_steps,
              const LimbStart& start, const LimbHull* parent)
      : plan_(plan),
        branch_(branch),
        children_(plan.children[branch]),
        narrowing_steps_(narrowing_steps),
        start_(start),
        parent_(parent) {
    part_.starts.resize(children_.size());
  }

  LimbPart build() {
    LimbPath path = limb_path();
    const bool is_root = parent_ == nullptr;
    const bool from_hole = !is_root && !start_.continues;

    std::vector<double> attach;
    attach.reserve(children_.size());
    const PathSearch search(path), own(plan_.paths[branch_]);
    for (int32_t child : children_) {
      attach.push_back(
          search.nearest_length(glm::dvec3(plan_.skeleton.branches[child].attach_point)));
    }
    const int32_t next = continuing_child(path, attach);
    if (next >= 0) {
      // The limb continues at the child's width where its own reaches zero.
      const double before = path.corners[path.corners.size() - 2];
      path.corners.back() =
          std::max(path.corners.back(), std::min(before, plan_.paths[next].corners.front()));
    }

    std::vector<ChildRequest> requests;
    requests.reserve(children_.size());
    for (size_t i = 0; i < children_.size(); ++i) {
      const int32_t child = children_[i];
      if (child == next) {
        continue;
      }
      const Exit exit = find_exit(search, own, attach[i], plan_.paths[child], child, plan_.scale,
                                  narrowing_steps_[child]);
      requests.push_back(exit.request);
      if (exit.clamped) {
        part_.clamped.push_back(child);
      }
    }
    const double gap = kKnuckleGap * corner_at(path, 0.5 * path.length());
    const KnuckleRow row =
        place_knuckles_between(std::move(requests), std::min(path.clear_from, 0.5 * path.length()),
                               path.length(), gap, sharp_bends(path, plan_.scale), plan_.scale);
    if (row.end > path.length()) {
      path.points.back() += direction_at(path, path.length()) * (row.end - path.length());
      measure(path);
    }

    StationOptions station_options;
    station_options.first_is_hole = from_hole;
    station_options.first_normal = is_root            ? direction_at(path, 0.0)
                                   : start_.continues ? start_.frame.normal
                                                      : start_.hole.normal;
    station_options.drop_all_cutting = narrowing_steps_[branch_] > 0;
    station_options.end_direction =
        next >= 0 ? direction_at(plan_.paths[next], 0.0) : direction_at(path, path.length());
    const std::vector<Station> stations =
        ring_stations(path, row.knuckles, plan_.scale, station_options);

    const std::vector<Frame> frames = emit_rings(stations);
    emit_walls(stations, frames, row.knuckles);
    if (next >= 0) {
      LimbStart& go_on = start_of(next);
      go_on.continues = true;
      go_on.frame = frames.back();
      go_on.corner = stations.back().corner;
      go_on.hole.centre = stations.back().centre;
      go_on.hole.vertices = part_.limb.rings.back().vertices;
    } else if (plan_.options.close_tips) {
      const Ring& tip = part_.limb.rings.back();
      const auto rows = static_cast<int32_t>(stations.size()) - 1;
      add_quad({tip.vertices[0], tip.vertices[1], tip.vertices[2], tip.vertices[3]},
               {branch_, rows, 0, 0, FacePart::kTipCap});
    }
    if (is_root && plan_.options.close_root) {
      const Ring& root = part_.limb.rings.front();
      add_quad({root.vertices[0], root.vertices[3], root.vertices[2], root.vertices[1]},
               {branch_, 0, 0, 0, FacePart::kRootCap});
    }
    if (!children_.empty()) {
      part_.hull = LimbHull(part_.limb.rings);
    }
    return std::move(part_);
  }

 private:
  LimbStart& start_of(int32_t child) { return part_.starts[plan_.sibling[child]]; }

  int32_t add_vertex(const glm::dvec3& p) {
    part_.vertices.push_back(p);
    return static_cast<int32_t>(part_.vertices.size()) - 1;
  }

  void add_quad(const Quad& quad, const FaceOrigin& origin) {
    part_.quads.push_back(quad);
    part_.origins.push_back(origin);
  }

  LimbPath limb_path() const {
    const LimbPath& own = plan_.paths[branch_];
    if (parent_ == nullptr) {
      return own;
    }
    if (!start_.continues) {
      return leave_parent(own, start_.hole, *parent_, plan_.scale, narrowing_steps_[branch_]);
    }
    LimbPath path = own;
    path.points[0] = start_.hole.centre;
    path.corners[0] = start_.corner;
    const double gap = 2.0 * plan_.scale.smallest_gap;
    while (path.points.size() > 2 && glm::distance(path.points[0], path.points[1]) < gap) {
      path.points.erase(path.points.begin() + 1);
      path.corners.erase(path.corners.begin() + 1);
      path.bone_lengths.erase(path.bone_lengths.begin() + 1);
    }
    if (glm::distance(path.points[0], path.points[1]) < gap) {
      path.points[1] = path.points[0] + start_.frame.normal * gap;
    }
    measure(path);
    return path;
  }

  /// The child that continues the parent's end ring: the straightest of those at the end.
  int32_t continuing_child(const LimbPath& path, const std::vector<double>& attach) const {
    const double end = path.length() * (1.0 - 1e-4) - plan_.scale.coincident;
    const glm::dvec3 direction = direction_at(path, path.length());
    int32_t best = -1;
    double best_cosine = kContinuesCosine;
    for (size_t i = 0; i < children_.size(); ++i) {
      const int32_t child = children_[i];
      const double cosine = glm::dot(direction, direction_at(plan_.paths[child], 0.0));
      // A limb whose parent in the file is another branch does not continue this one.
      const bool own = plan_.skeleton.branches[child].parent == branch_;
      if (own && attach[i] >= end && cosine > best_cosine) {
        best_cosine = cosine;
        best = child;
      }
    }
    return best;
  }

  std::vector<Frame> emit_rings(const std::vector<Station>& stations) {
    LimbSurface& limb = part_.limb;
    limb.continues_parent = start_.continues;
    std::vector<Frame> frames;
    frames.reserve(stations.size());
    limb.rings.reserve(stations.size());
    // A ring, or an inset around a child's hole, has four of each.
    part_.vertices.reserve(4 * (stations.size() + children_.size()));
    part_.quads.reserve(4 * (stations.size() + children_.size()));
    part_.origins.reserve(4 * (stations.size() + children_.size()));
    for (size_t i = 0; i < stations.size(); ++i) {
      const Station& station = stations[i];
      Ring ring;
      ring.centre = station.centre;
      ring.normal = station.normal;
      ring.corner = station.corner;
      ring.bone_length = station.bone_length;
      if (i == 0) {
        if (parent_ == nullptr) {
          frames.push_back(first_frame(station.normal));
        } else {
          frames.push_back(start_.frame);
          ring.vertices = {-1, -2, -3, -4};
        }
      } else if (i == 1 && parent_ != nullptr && !start_.continues) {
        frames.push_back(fit_frame(start_.hole.corners, station.normal));
      } else {
        frames.push_back(transport(frames.back(), station.normal));
      }
      if (i > 0 || parent_ == nullptr) {
        const auto corners = ring_corners(frames.back(), ring.centre, ring.corner);
        for (int k = 0; k < 4; ++k) {
          ring.vertices[k] = add_vertex(corners[k]);
        }
      }
      limb.rings.push_back(ring);
    }
    return frames;
  }

  /// Assigns each child of a knuckle the side that faces it, maximising the sum of the cosines.
  static std::array<int, 4> assign_sides(const Knuckle& knuckle, const Frame& frame) {
    std::array<std::array<double, 4>, 4> cosine{};
    for (int side = 0; side < 4; ++side) {
      const glm::dvec3 direction = side_direction(frame, side);
      for (size_t i = 0; i < knuckle.children.size(); ++i) {
        cosine[i][side] = glm::dot(knuckle.children[i].direction, direction);
      }
    }
    std::array<int, 4> order = {0, 1, 2, 3}, best{};
    double best_score = -1e300;
    do {
      double score = 0.0;
      for (size_t i = 0; i < knuckle.children.size(); ++i) {
        score += cosine[i][order[i]];
      }
      if (score > best_score + 1e-12) {
        best_score = score;
        best = order;
      }
    } while (std::next_permutation(order.begin(), order.end()));
    return best;
  }

  void emit_walls(const std::vector<Station>& stations, const std::vector<Frame>& frames,
                  const std::vector<Knuckle>& knuckles) {
    for (int32_t row = 0; row + 1 < static_cast<int32_t>(stations.size()); ++row) {
      std::array<const ChildRequest*, 4> leaving{};
      const Station& station = stations[row];
      if (station.kind == Station::Kind::kKnuckleBegin) {
        const Knuckle& knuckle = knuckles[station.knuckle];
        const std::array<int, 4> sides = assign_sides(knuckle, frames[row]);
        for (size_t i = 0; i < knuckle.children.size(); ++i) {
          leaving[sides[i]] = &knuckle.children[i];
        }
      }
      for (int side = 0; side < 4; ++side) {
        const Ring& low = part_.limb.rings[row];
        const Ring& high = part_.limb.rings[row + 1];
        const int after = (side + 1) % 4;
        const Quad quad = {low.vertices[side], low.vertices[after], high.vertices[after],
                           high.vertices[side]};
        if (leaving[side] == nullptr) {
          add_quad(quad, {branch_, row, side, 0, FacePart::kWall});
        } else {
          open_side(row, side, quad, *leaving[side], knuckles[station.knuckle]);
        }
      }
    }
  }

  /// Opens a knuckle's side for a child, with an inset around the hole for thinner children.
  void open_side(int32_t row, int side, const Quad& quad, const ChildRequest& request,
                 const Knuckle& knuckle) {
    std::array<glm::dvec3, 4> outer;
    for (int k = 0; k < 4; ++k) {
      outer[k] = part_.vertices[quad[k]];
    }
    const double across =
        0.5 * (glm::distance(outer[0], outer[1]) + glm::distance(outer[3], outer[2]));
    const double along =
        0.5 * (glm::distance(outer[0], outer[3]) + glm::distance(outer[1], outer[2]));
    const LimbSurface& limb = part_.limb;
    Junction junction{
        branch_, request.child,
        row,     side,
        false,   0.5 * (limb.rings[row].bone_length + limb.rings[row + 1].bone_length)};

    Hole& hole = start_of(request.child).hole;
    hole.vertices = {quad[0], quad[1], quad[2], quad[3]};
    hole.corners = outer;
    hole.crotch = request.crotch;
    junction.inset = request.width < kInsetBelow * across || request.hole_length < 0.6 * along;
    if (junction.inset) {
      const double half_x = 0.5 * std::min(request.width / across, 1.0 - 2.0 * kInsetMargin);
      const double half_y = 0.5 * std::min(request.hole_length / along, 1.0 - 2.0 * kInsetMargin);
      const glm::dvec3 x_axis = glm::normalize(outer[1] - outer[0] + outer[2] - outer[3]);
      const glm::dvec3 y_axis = glm::normalize(outer[3] - outer[0] + outer[2] - outer[1]);
      const glm::dvec3 normal = glm::cross(x_axis, y_axis);
      const double slant =
          glm::dot(request.direction, x_axis) / std::max(0.3, glm::dot(request.direction, normal));
      const double wanted_y = (request.position - knuckle.begin) / (knuckle.end - knuckle.begin);
      const double margin_x =
          half_x + std::max(kInsetMargin, std::min(half_x, kFreeMargin * (1.0 - 2.0 * half_x)));
      const double margin_y = half_y + std::max(kInsetMargin, kFreeMargin * (1.0 - 2.0 * half_y));
      const double x = std::clamp(0.5 + 0.5 * slant, margin_x, 1.0 - margin_x);
      const double y = std::clamp(wanted_y, margin_y, 1.0 - margin_y);
      const auto on_side = [&](double a, double c) {
        return (outer[0] * (1.0 - a) + outer[1] * a) * (1.0 - c) +
               (outer[3] * (1.0 - a) + outer[2] * a) * c;
      };
      hole.corners = {on_side(x - half_x, y - half_y), on_side(x + half_x, y - half_y),
                      on_side(x + half_x, y + half_y), on_side(x - half_x, y + half_y)};
      for (int k = 0; k < 4; ++k) {
        hole.vertices[k] = add_vertex(hole.corners[k]);
      }
      for (int k = 0; k < 4; ++k) {
        const int after = (k + 1) % 4;
        add_quad({quad[k], quad[after], hole.vertices[after], hole.vertices[k]},
                 {branch_, row, side, k, FacePart::kInset});
      }
      const double low = limb.rings[row].bone_length, high = limb.rings[row + 1].bone_length;
      junction.parent_bone_length = low + (high - low) * y;
    }
    hole.centre = 0.25 * (hole.corners[0] + hole.corners[1] + hole.corners[2] + hole.corners[3]);
    const glm::dvec3 area =
        0.5 * glm::cross(hole.corners[2] - hole.corners[0], hole.corners[3] - hole.corners[1]);
    hole.normal = glm::normalize(area);
    hole.corner = std::max(plan_.scale.smallest_corner, std::sqrt(0.5 * glm::length(area)));
    hole.parent_corner = 0.5 * (limb.rings[row].corner + limb.rings[row + 1].corner);
    part_.junctions.push_back(junction);
    const double length = 0.5 * (glm::distance(hole.corners[0], hole.corners[3]) +
                                 glm::distance(hole.corners[1], hole.corners[2]));
    if (length < kSqueezedBelow * request.width) {
      part_.squeezed.push_back(request.child);
    }
  }

  const LimbPlan& plan_;
  int32_t branch_;
  const std::vector<int32_t>& children_;
  const std::vector<uint8_t>& narrowing_steps_;
  const LimbStart& start_;
  const LimbHull* parent_;
  LimbPart part_;
};

}  // namespace

LimbPart build_limb(const LimbPlan& plan, int32_t branch,
                    const std::vector<uint8_t>& narrowing_steps, const LimbStart& start,
                    const LimbHull* parent) {
  return LimbBuilder(plan, branch, narrowing_steps, start, parent).build();
}

}  // namespace snowbough::tree
