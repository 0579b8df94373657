#include "tree/surface.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "tree/frames.h"
#include "tree/knuckles.h"
#include "tree/surface_base.h"
#include "tree/surface_stations.h"

namespace snowbough::tree {
namespace {

/// A child thinner than this share of a knuckle's side gets an inset.
constexpr double kInsetBelow = 0.9;
/// Share of the side that stays around an inset hole, at least, on each edge.
constexpr double kInsetMargin = 0.08;
/// The same along the limb, as a share of what the hole leaves free: it moves towards its child,
/// not up to the knuckle's end, or slivers would remain there that show as dark lines.
constexpr double kFreeMargin = 0.35;
/// A hole shorter along its limb than this share of the child's width squeezes the child.
constexpr double kSqueezedBelow = 0.8;
/// Gap wanted between knuckles, in corner radii of the limb.
constexpr double kKnuckleGap = 0.3;
/// A child that turns back further than this (cosine) does not continue from its parent's end ring.
constexpr double kContinuesCosine = -0.3;

/// Builds the limbs one after the other, parents before children.
class SurfaceBuilder {
 public:
  SurfaceBuilder(const Skeleton& skeleton, const std::vector<LimbPath>& paths,
                 const SurfaceScale& scale, const SurfaceOptions& options,
                 const std::vector<uint8_t>& relief, const std::vector<uint8_t>& only)
      : skeleton_(skeleton),
        paths_(paths),
        scale_(scale),
        options_(options),
        relief_(relief),
        only_(only),
        children_(paths.size()),
        starts_(paths.size()) {
    surface_.limbs.resize(paths.size());
    for (size_t b = 0; b < paths.size(); ++b) {
      if (skeleton.branches[b].parent >= 0) {
        children_[skeleton.branches[b].parent].push_back(static_cast<int32_t>(b));
      }
    }
  }

  Surface build() {
    for (int32_t b = 0; b < static_cast<int32_t>(paths_.size()); ++b) {
      if (only_.empty() || only_[b] != 0) {
        build_limb(b);
      } else if (const int32_t parent = skeleton_.branches[b].parent;
                 parent >= 0 && only_[parent] != 0) {
        surface_.limbs[b].rings.emplace_back().vertices = starts_[b].hole.vertices;
      }
    }
    return std::move(surface_);
  }

 private:
  /// What a parent prepared for a child: its hole, or its own end ring.
  struct Start {
    Hole hole;
    bool continues = false;
    Frame frame;
    double corner = 0.0;
  };

  int32_t add_vertex(const glm::dvec3& p) {
    surface_.vertices.push_back(p);
    return static_cast<int32_t>(surface_.vertices.size()) - 1;
  }

  void add_quad(const Quad& quad, const FaceOrigin& origin) {
    surface_.quads.push_back(quad);
    surface_.origins.push_back(origin);
  }

  LimbPath limb_path(int32_t b) const {
    const Branch& branch = skeleton_.branches[b];
    if (branch.parent < 0) {
      return paths_[b];
    }
    const Start& start = starts_[b];
    if (!start.continues) {
      return leave_parent(paths_[b], start.hole, surface_.limbs[branch.parent], scale_, relief_[b]);
    }
    LimbPath path = paths_[b];
    path.points[0] = start.hole.centre;
    path.corners[0] = start.corner;
    while (path.points.size() > 2 &&
           glm::distance(path.points[0], path.points[1]) < 2.0 * scale_.smallest_gap) {
      path.points.erase(path.points.begin() + 1);
      path.corners.erase(path.corners.begin() + 1);
      path.bone_lengths.erase(path.bone_lengths.begin() + 1);
    }
    if (glm::distance(path.points[0], path.points[1]) < 2.0 * scale_.smallest_gap) {
      path.points[1] = path.points[0] + start.frame.normal * (2.0 * scale_.smallest_gap);
    }
    measure(path);
    return path;
  }

  /// The child that goes on from the parent's end ring: of those that sit at the end, the
  /// straightest.
  int32_t continuing_child(int32_t b, const LimbPath& path,
                           const std::vector<double>& attach) const {
    const double end = path.length() * (1.0 - 1e-4) - scale_.coincident;
    const glm::dvec3 direction = direction_at(path, path.length());
    int32_t best = -1;
    double best_cosine = kContinuesCosine;
    for (size_t i = 0; i < children_[b].size(); ++i) {
      const int32_t child = children_[b][i];
      const double cosine = glm::dot(direction, direction_at(paths_[child], 0.0));
      if (attach[i] >= end && cosine > best_cosine) {
        best_cosine = cosine;
        best = child;
      }
    }
    return best;
  }

  void build_limb(int32_t b) {
    LimbPath path = limb_path(b);
    const Start& start = starts_[b];
    const bool is_root = skeleton_.branches[b].parent < 0;
    const bool from_hole = !is_root && !start.continues;

    std::vector<double> attach;
    for (int32_t child : children_[b]) {
      attach.push_back(nearest_length(path, glm::dvec3(skeleton_.branches[child].attach_point)));
    }
    const int32_t next = continuing_child(b, path, attach);
    if (next >= 0) {
      // The limb goes on at the child's width where its own has run out.
      const double before = path.corners[path.corners.size() - 2];
      path.corners.back() =
          std::max(path.corners.back(), std::min(before, paths_[next].corners.front()));
    }

    std::vector<ChildRequest> requests;
    for (size_t i = 0; i < children_[b].size(); ++i) {
      const int32_t child = children_[b][i];
      if (child == next) {
        continue;
      }
      const Exit exit = find_exit(path, attach[i], paths_[child], child, scale_, relief_[child]);
      requests.push_back(exit.request);
      if (exit.clamped) {
        surface_.clamped.push_back(child);
      }
    }
    const double gap = kKnuckleGap * corner_at(path, 0.5 * path.length());
    const KnuckleRow row =
        place_knuckles_between(std::move(requests), std::min(path.clear_from, 0.5 * path.length()),
                               path.length(), gap, sharp_bends(path, scale_), scale_);
    if (row.end > path.length()) {
      path.points.back() += direction_at(path, path.length()) * (row.end - path.length());
      measure(path);
    }

    StationOptions station_options;
    station_options.first_is_hole = from_hole;
    station_options.first_normal = is_root           ? direction_at(path, 0.0)
                                   : start.continues ? start.frame.normal
                                                     : start.hole.normal;
    station_options.drop_all_cutting = relief_[b] > 0;
    station_options.end_direction =
        next >= 0 ? direction_at(paths_[next], 0.0) : direction_at(path, path.length());
    const std::vector<Station> stations =
        ring_stations(path, row.knuckles, scale_, station_options);

    const std::vector<Frame> frames = emit_rings(b, stations, is_root);
    emit_walls(b, stations, frames, row.knuckles);
    if (next >= 0) {
      Start& go_on = starts_[next];
      go_on.continues = true;
      go_on.frame = frames.back();
      go_on.corner = stations.back().corner;
      go_on.hole.centre = stations.back().centre;
      go_on.hole.vertices = surface_.limbs[b].rings.back().vertices;
    } else if (options_.close_tips) {
      const Ring& tip = surface_.limbs[b].rings.back();
      const auto rows = static_cast<int32_t>(stations.size()) - 1;
      add_quad({tip.vertices[0], tip.vertices[1], tip.vertices[2], tip.vertices[3]},
               {b, rows, 0, 0, FacePart::kTipCap});
    }
    if (is_root && options_.close_root) {
      const Ring& root = surface_.limbs[b].rings.front();
      add_quad({root.vertices[0], root.vertices[3], root.vertices[2], root.vertices[1]},
               {b, 0, 0, 0, FacePart::kRootCap});
    }
  }

  std::vector<Frame> emit_rings(int32_t b, const std::vector<Station>& stations, bool is_root) {
    const Start& start = starts_[b];
    LimbSurface& limb = surface_.limbs[b];
    limb.continues_parent = start.continues;
    std::vector<Frame> frames;
    for (size_t i = 0; i < stations.size(); ++i) {
      const Station& station = stations[i];
      Ring ring;
      ring.centre = station.centre;
      ring.normal = station.normal;
      ring.corner = station.corner;
      ring.bone_length = station.bone_length;
      if (i == 0) {
        if (is_root) {
          frames.push_back(first_frame(station.normal));
        } else {
          frames.push_back(start.frame);
          ring.vertices = start.hole.vertices;
        }
      } else if (i == 1 && !is_root && !start.continues) {
        frames.push_back(fit_frame(start.hole.corners, station.normal));
      } else {
        frames.push_back(transport(frames.back(), station.normal));
      }
      if (i > 0 || is_root) {
        const auto corners = ring_corners(frames.back(), ring.centre, ring.corner);
        for (int k = 0; k < 4; ++k) {
          ring.vertices[k] = add_vertex(corners[k]);
        }
      }
      limb.rings.push_back(ring);
    }
    return frames;
  }

  /// Gives each child of a knuckle the side that faces it, so that the sum of the cosines is
  /// largest.
  static std::array<int, 4> assign_sides(const Knuckle& knuckle, const Frame& frame) {
    std::array<int, 4> order = {0, 1, 2, 3}, best{};
    double best_score = -1e300;
    do {
      double score = 0.0;
      for (size_t i = 0; i < knuckle.children.size(); ++i) {
        score += glm::dot(knuckle.children[i].direction, side_direction(frame, order[i]));
      }
      if (score > best_score + 1e-12) {
        best_score = score;
        best = order;
      }
    } while (std::next_permutation(order.begin(), order.end()));
    return best;
  }

  void emit_walls(int32_t b, const std::vector<Station>& stations, const std::vector<Frame>& frames,
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
        const Ring& low = surface_.limbs[b].rings[row];
        const Ring& high = surface_.limbs[b].rings[row + 1];
        const int after = (side + 1) % 4;
        const Quad quad = {low.vertices[side], low.vertices[after], high.vertices[after],
                           high.vertices[side]};
        if (leaving[side] == nullptr) {
          add_quad(quad, {b, row, side, 0, FacePart::kWall});
        } else {
          open_side(b, row, side, quad, *leaving[side], knuckles[station.knuckle]);
        }
      }
    }
  }

  /// Leaves a knuckle's side open for a child, with an inset around the hole where the child is
  /// thinner.
  void open_side(int32_t b, int32_t row, int side, const Quad& quad, const ChildRequest& request,
                 const Knuckle& knuckle) {
    std::array<glm::dvec3, 4> outer;
    for (int k = 0; k < 4; ++k) {
      outer[k] = surface_.vertices[quad[k]];
    }
    const double across =
        0.5 * (glm::distance(outer[0], outer[1]) + glm::distance(outer[3], outer[2]));
    const double along =
        0.5 * (glm::distance(outer[0], outer[3]) + glm::distance(outer[1], outer[2]));
    const LimbSurface& limb = surface_.limbs[b];
    Junction junction{b,     request.child,
                      row,   side,
                      false, 0.5 * (limb.rings[row].bone_length + limb.rings[row + 1].bone_length)};

    Hole& hole = starts_[request.child].hole;
    hole.vertices = {quad[0], quad[1], quad[2], quad[3]};
    hole.corners = outer;
    junction.inset = request.width < kInsetBelow * across || request.width < 0.6 * along;
    if (junction.inset) {
      const double half_x = 0.5 * std::min(request.width / across, 1.0 - 2.0 * kInsetMargin);
      const double half_y = 0.5 * std::min(request.width / along, 1.0 - 2.0 * kInsetMargin);
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
                 {b, row, side, k, FacePart::kInset});
      }
      const double low = limb.rings[row].bone_length, high = limb.rings[row + 1].bone_length;
      junction.parent_bone_length = low + (high - low) * y;
    }
    hole.centre = 0.25 * (hole.corners[0] + hole.corners[1] + hole.corners[2] + hole.corners[3]);
    const glm::dvec3 area =
        0.5 * glm::cross(hole.corners[2] - hole.corners[0], hole.corners[3] - hole.corners[1]);
    hole.normal = glm::normalize(area);
    hole.corner = std::max(scale_.smallest_corner, std::sqrt(0.5 * glm::length(area)));
    hole.parent_corner = 0.5 * (limb.rings[row].corner + limb.rings[row + 1].corner);
    surface_.junctions.push_back(junction);
    const double length = 0.5 * (glm::distance(hole.corners[0], hole.corners[3]) +
                                 glm::distance(hole.corners[1], hole.corners[2]));
    if (length < kSqueezedBelow * request.width) {
      surface_.squeezed.push_back(request.child);
    }
  }

  const Skeleton& skeleton_;
  const std::vector<LimbPath>& paths_;
  const SurfaceScale& scale_;
  const SurfaceOptions& options_;
  const std::vector<uint8_t>& relief_;
  const std::vector<uint8_t>& only_;
  std::vector<std::vector<int32_t>> children_;
  std::vector<Start> starts_;
  Surface surface_;
};

}  // namespace

Surface build_surface(const Skeleton& skeleton, const std::vector<LimbPath>& paths,
                      const SurfaceScale& scale, const SurfaceOptions& options,
                      const std::vector<uint8_t>& relief, const std::vector<uint8_t>& only) {
  return SurfaceBuilder(skeleton, paths, scale, options, relief, only).build();
}

}  // namespace snowbough::tree
