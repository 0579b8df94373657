#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "shaders/lib/snow_surface.h"
#include "snow/surface/cushions.h"
#include "snow/surface/refine.h"
#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// Inputs that determine the faces of a surface. The faces stay the same for the whole shot.
struct SurfacePlan {
  SurfaceDensity density;
  /// Seed of the noise, so that receivers differ.
  uint32_t seed = 0;
  /// Horizontal part of the unit vector of the snowfall's direction, averaged over the shot. Rims
  /// on the lee side get cornices.
  glm::vec2 wind{0.0f};

  /// Offset of positions in noise space, as a fraction of the depth, so that receivers differ.
  glm::vec3 noise_shift() const {
    return glm::vec3(0.31f, 0.77f, 0.53f) * static_cast<float>(seed % 9973u);
  }
};

/// Faces of three or four corners.
struct SurfaceFaces {
  /// Face f has the corners begin[f] to begin[f + 1] - 1.
  std::vector<int32_t> begin;
  std::vector<int32_t> corner;
  /// Texture coordinates of the corners, in the receiver's UV map.
  std::vector<glm::vec2> uv;
};

/// A frame of the shot.
struct SurfaceFrame {
  /// Heights in metres, negative on the back, resolution x resolution.
  const float* height = nullptr;
  /// Snow depth on open level ground, in metres.
  float open_depth = 0.0f;
  /// The receiver's vertices in world space, in metres. Null if the receiver only moved rigidly
  /// since the plan's pose.
  const glm::vec3* positions = nullptr;
  /// The direction up in the plan's pose, for a receiver that moves rigidly and tilts.
  glm::vec3 up{0.0f, 0.0f, 1.0f};
  /// Matrix to the space of the result: from world space (with `positions`) or from the plan's pose
  /// (without `positions`), both in metres.
  glm::mat4 to_result{1.0f};
};

/// The snow surface of one receiver. The constructor makes the faces once, from the receiver's pose
/// and the heights in the shot's last frame. Each frame computes the points by the formula of
/// shaders/lib/snow_surface.h. The same input gives the same points for any number of threads.
class SnowSurface {
 public:
  /// @throws std::invalid_argument if a map does not have resolution^2 texels, or if the positions
  /// or the shading do not match the source.
  SnowSurface(const SurfaceSource& source, const std::vector<float>& last,
              const std::vector<float>& highest, const SurfacePlan& plan);

  const SurfaceFaces& faces() const { return faces_; }
  size_t point_count() const { return mesh_.position.size() + cushions_.anchor.size(); }
  /// Factor by which hems are coarser than the plan's density asks for, for lack of points.
  float coarsened() const { return coarsened_; }
  /// The artist's settings. The faces do not depend on them.
  void set_style(const shared::SnowStyle& style) { style_ = style; }

  /// @return one position per point of the faces.
  std::vector<glm::vec3> points(const SurfaceFrame& frame) const;

 private:
  /// Number of points on the receiver; the remaining points belong to the cushions.
  size_t lying_points() const { return mesh_.position.size(); }
  /// Shown thickness of the snow at the points on the receiver in `frame`, in metres; 0 at bare
  /// points.
  std::vector<float> shown_heights(const SurfaceFrame& frame) const;
  /// Drops the faces of sheets that never show snow, because a sheet has no other side to hide
  /// them.
  void drop_bare_sheets(const std::vector<float>& highest, float depth);
  void find_cushions(float depth, const std::vector<float>& last, int32_t most_points);
  /// Heights of one frame at the points.
  struct Heights {
    /// Thickness from the map, smoothed.
    std::vector<float> thickness;
    /// Height of the shown snow.
    std::vector<float> shown;
  };
  void find_normals(float reach);
  void find_carriers(const SurfaceSource& source);
  void find_samples();
  void find_neighbours(float reach);
  void find_noise(const SurfacePlan& plan);
  void find_thickness(const base::TriangleTree& tree, float depth);
  void find_fronts(const Rims& rims, const RimZones& zones, const SurfacePlan& plan);
  void find_presence(const SurfacePlan& plan, const std::vector<float>& last);
  void smooth_presence();
  /// Mean height behind the rim of a front; bare points count as 0.
  float inland_height(size_t front, const std::vector<float>& height) const;
  /// Share of a front's shape in the surface, 0 to 1, with `inland` metres of snow behind its rim.
  /// A bridge is a front as a whole: it holds the snow that the map has in the gap.
  float presence(size_t front, float inland) const;
  void find_convexity(float depth);
  void find_bumps(const SurfacePlan& plan, const std::vector<glm::vec3>& shown);
  void make_faces();
  Heights heights(const SurfaceFrame& frame, const std::vector<glm::vec3>& normals) const;
  void smooth(std::vector<float>& values, int rounds) const;
  std::vector<glm::vec3> offsets(const SurfaceFrame& frame, const std::vector<glm::vec3>& normals,
                                 const Heights& heights) const;

  SurfaceMesh mesh_;
  /// Unit normals of the points: a weighted mean over their corners, smoothed across creases.
  std::vector<glm::vec3> normal_;
  SurfaceFaces faces_;
  shared::SnowStyle style_{1.0f, 1.0f, 1.0f, 1.0f};
  float coarsened_ = 1.0f;
  int32_t resolution_ = 0;
  std::vector<int32_t> triangles_;
  std::vector<glm::vec3> planned_positions_;

  std::vector<int32_t> carrier_triangle_;
  std::vector<glm::vec2> carrier_weight_;
  /// Offset from the flat carrier to the curved surface that the normals describe.
  std::vector<glm::vec3> curvature_;
  /// 1 or -1: the side of the receiver's faces that carries the snow.
  std::vector<float> side_;
  /// Samples of the map; the samples of point p start at sample_begin_[p].
  std::vector<int32_t> sample_begin_;
  std::vector<int32_t> sample_texel_;
  std::vector<glm::vec2> sample_share_;
  std::vector<float> sample_weight_;
  /// Neighbours, weighted by distance; those of point p start at neighbour_begin_[p].
  std::vector<int32_t> neighbour_begin_;
  std::vector<int32_t> neighbour_;
  std::vector<float> neighbour_weight_;
  /// Area of the receiver's surface that a point represents, in m2.
  std::vector<float> area_;
  std::vector<shared::SnowPoint> point_;
  /// 1 for points on sheets, which are parts without a back side.
  std::vector<uint8_t> is_sheet_;
  Cushions cushions_;
  /// Thickness of the snow at the cushions' anchors in the last frame.
  std::vector<float> cushion_height_;
  /// Points in the zones of rims: point index, constants, and four points behind the rim with their
  /// weights.
  std::vector<int32_t> front_point_;
  std::vector<shared::SnowFront> front_;
  /// Distance from the rim to the middle of the top, in metres.
  std::vector<float> room_;
  std::vector<glm::ivec4> front_inland_;
  std::vector<glm::vec4> front_weight_;
};

/// Unit normals of points: the area-weighted mean over the triangles of each point, or straight up
/// if a point has no triangles.
/// @throws std::invalid_argument if a triangle has an index without a point.
std::vector<glm::vec3> point_normals(const std::vector<glm::vec3>& points,
                                     const std::vector<glm::ivec3>& triangles);

}  // namespace snowbough::snow
