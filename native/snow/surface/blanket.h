#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/surface/cell_grid.h"
#include "snow/surface/nearest_points.h"
#include "snow/surface/rims.h"
#include "snow/surface/surface_points.h"

namespace snowbough::snow {

/// The top of snow that goes on over steps and gaps, such as those between tiles, stones and slats:
/// one smooth surface over all of them. Its nodes stand for the points of a few centimetres; each
/// has a plane through the tops of the snow around it.
class Blanket {
 public:
  /// A point near a step or a gap that snow may hide.
  struct Member {
    int32_t point = 0;
    /// The front that holds the point, or -1.
    int32_t front = -1;
    /// On the far face of a rim: it has no thickness of its own.
    bool is_far = false;
    /// Behind a rim below another piece.
    bool in_shelter = false;
    /// Height of the step in metres.
    float step = 0.0f;
    /// At the foot of a step: share of the blanket if the snow hides the step, and by how much the
    /// point lies below it, further in below the upper piece, in metres.
    float foot = 0.0f;
    float tucked = 0.0f;
    /// Points off the foot or behind the rim, and the share of the thickness there in the blanket:
    /// maps have a furrow at a step, as their snow is rounded off towards it.
    PointMean off;
    float filled = 0.0f;
  };

  Blanket() = default;
  /// @param lying the points that snow can lie on, open to the sky; `area`: of all points, in m2.
  Blanket(const SurfacePoints& points, const std::vector<int32_t>& lying,
          const std::vector<float>& area, std::vector<Member> members, float depth);

  bool empty() const { return members_.empty(); }
  /// Turns the normals of points at feet upright that lean away from the ground around them, as on
  /// bevels and at the ends of pieces that lie below others: a blanket would be drawn beside them.
  /// Then finds the blanket where the snow of `thickness` along the normals ends: on a slope that
  /// is beside its point, and points of two pieces must find the same there.
  /// @param upper  normals of the most level faces at the points.
  void aim(const SurfacePoints& points, const std::vector<glm::vec3>& upper,
           const std::vector<float>& thickness, std::vector<glm::vec3>& normal);

  /// Replaces the thickness of the snow at the members by that up to the blanket, as far as the
  /// snow hides the step.
  /// @param goes_on per front, 0 to 1: how far its snow joins that beyond the rim; becomes how far
  ///   the blanket has its shape.
  /// @param ups  become the blanket's unit normals per front.
  /// @return that share of each point.
  std::vector<float> lay(const SurfacePoints& points, std::vector<float>& goes_on,
                         std::vector<glm::vec3>& ups, std::vector<float>& thickness) const;

 private:
  static constexpr int kNodes = 8;
  struct Node {
    glm::vec3 centre{0.0f};
    float area = 0.0f;
    /// Upward slope of the plane through the receiver.
    glm::vec3 ground{0.0f};
  };
  struct Near {
    std::array<int32_t, kNodes> node{};
    std::array<float, kNodes> weight{};
    /// Height of the mean plane through the receiver, in metres, and its unit normal.
    float ground = 0.0f;
    glm::vec3 up{0.0f, 0.0f, 1.0f};
  };
  /// The blanket above or below a place: its height in metres and its unit normal.
  struct Here {
    float z = 0.0f;
    glm::vec3 up{0.0f, 0.0f, 1.0f};
    bool is_found = false;
  };
  struct Share {
    int32_t index = 0;
    float weight = 0.0f;
  };
  struct PlanePart {
    int32_t node = 0;
    /// Parts of a node's height in the value and in both slopes of the plane.
    glm::vec3 part{0.0f};
  };

  /// Makes the nodes, and the shares of the points in them.
  void find_nodes(const SurfacePoints& points, const std::vector<int32_t>& lying,
                  const std::vector<float>& area, float depth);
  CellGrid node_grid() const;
  /// Calls visit(index, node, from the node's centre to the place, its length) for the nodes less
  /// than `reach` from a place.
  template <typename Visit>
  void visit_nodes(const CellGrid& grid, const glm::vec3& place, float reach,
                   const Visit& visit) const;
  /// 1 for a place near a node's plane through the receiver, 0 far from it.
  static float on_ground_of(const Node& node, const glm::vec3& from_centre, float depth);
  /// Fits planes through the receiver, and finds from them what the tops of the snow around a node
  /// add to the plane through them.
  void fit_ground(const CellGrid& grid, float depth);
  void find_plane_parts(const CellGrid& grid, float depth);
  /// By node, the plane through the tops of the snow around it: its slopes along x and y, and its
  /// height at the node's centre.
  std::vector<glm::vec3> planes_on(const std::vector<float>& thickness) const;
  Here here(const Near& near, const glm::vec3& place, const std::vector<glm::vec3>& planes) const;
  Near nodes_near(const glm::vec3& place, const CellGrid& grid, float depth) const;

  std::vector<Member> members_;
  float depth_ = 0.0f;
  std::vector<Node> nodes_;
  std::vector<Near> near_;
  /// The points of each node with their weights, divided by the upward component of the normal.
  std::vector<int32_t> share_begin_, part_begin_;
  std::vector<Share> shares_;
  std::vector<PlanePart> parts_;
};

/// Share of the thickness behind a rim at a distance from it.
float filled_behind(float distance, float depth);
/// True if a point with this unit normal lies at the foot of a step.
bool is_at_foot(const Rims& rims, const glm::vec3& point, const glm::vec3& normal, float depth);

/// The points of `lying` at the feet of steps. `position`, `normal`: of all points.
std::vector<Blanket::Member> find_feet(const std::vector<glm::vec3>& position,
                                       const std::vector<glm::vec3>& normal, const Rims& rims,
                                       const NearestPoints& lying, float depth);

}  // namespace snowbough::snow
