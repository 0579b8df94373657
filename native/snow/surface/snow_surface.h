#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "shaders/lib/snow_surface.h"
#include "snow/surface/cushions.h"
#include "snow/surface/refine.h"
#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// What decides about the faces of a surface; they stay the same for the whole shot.
struct SurfacePlan {
  SurfaceDensity density;
  /// Noise differs from receiver to receiver.
  uint32_t seed = 0;
  /// Horizontal part of the unit vector in which snow falls, on average over the shot: rims on the
  /// lee side get cornices.
  glm::vec2 wind{0.0f};

  /// What is added to places in noise, in parts of the depth, so that receivers differ.
  glm::vec3 noise_shift() const {
    return glm::vec3(0.31f, 0.77f, 0.53f) * static_cast<float>(seed % 9973u);
  }
};

/// Faces of three or four corners.
struct SurfaceFaces {
  /// Corners of face f are begin[f] to begin[f + 1] - 1.
  std::vector<int32_t> begin;
  std::vector<int32_t> corner;
  /// Texture coordinates of the corners, in the receiver's UV map.
  std::vector<glm::vec2> uv;
};

/// A frame of the shot.
struct SurfaceFrame {
  /// Heights in metres, negative on the back, resolution x resolution.
  const float* height = nullptr;
  /// Metres of snow on open level ground.
  float open_depth = 0.0f;
  /// The receiver's vertices in metres in the world, or null while it is as in the plan but for
  /// moving as a whole.
  const glm::vec3* positions = nullptr;
  /// Where up is in the plan's pose: for a receiver that moves as a whole and tilts.
  glm::vec3 up{0.0f, 0.0f, 1.0f};
  /// From metres in the world (with `positions`), or in the plan's pose (without), to what points
  /// are wanted in.
  glm::mat4 to_result{1.0f};
};

/// The surface of the snow on one receiver: DESIGN 4.6. Faces are made once, from the receiver as
/// it is in the shot's last frame and the heights that lie there then; each frame gives their
/// points by shaders/lib/snow_surface.h. Same input, same points, whatever the number of threads.
class SnowSurface {
 public:
  /// @throws std::invalid_argument for a map of other than resolution^2 texels or positions that do
  /// not fit.
  SnowSurface(const SurfaceSource& source, const std::vector<float>& last,
              const std::vector<float>& highest, const SurfacePlan& plan);

  const SurfaceFaces& faces() const { return faces_; }
  size_t point_count() const { return mesh_.position.size() + cushions_.anchor.size(); }
  /// What an artist sets; faces do not depend on it.
  void set_style(const shared::SnowStyle& style) { style_ = style; }

  /// @return a point for each of the faces' points.
  std::vector<glm::vec3> points(const SurfaceFrame& frame) const;

 private:
  /// Points that lie on the receiver; the others are the cushions'.
  size_t lying_points() const { return mesh_.position.size(); }
  /// Thickness of the snow at the points that lie on the receiver in metres as it shows in `frame`,
  /// 0 where it is bare.
  std::vector<float> shown_heights(const SurfaceFrame& frame) const;
  /// Drops faces of sheets that never show snow: behind a sheet nothing hides them.
  void drop_bare_sheets(const std::vector<float>& highest, float depth);
  void find_cushions(float depth, const std::vector<float>& last);
  /// What a frame's heights come to at the points.
  struct Heights {
    /// Of the map, smoothed.
    std::vector<float> thickness;
    /// Of the shown snow.
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
  /// Mean of the heights behind the rim of a front, bare ones as 0.
  float inland_height(size_t front, const std::vector<float>& height) const;
  void find_convexity(float depth);
  void find_bumps(const SurfacePlan& plan, const std::vector<glm::vec3>& shown);
  void make_faces();
  Heights heights(const SurfaceFrame& frame, const std::vector<glm::vec3>& normals) const;
  void smooth(std::vector<float>& values, int rounds) const;
  std::vector<glm::vec3> offsets(const SurfaceFrame& frame, const std::vector<glm::vec3>& normals,
                                 const Heights& heights) const;

  SurfaceMesh mesh_;
  /// Unit normals of the points, the mean of their corners'.
  std::vector<glm::vec3> normal_;
  SurfaceFaces faces_;
  shared::SnowStyle style_{1.0f, 1.0f, 1.0f, 1.0f};
  int32_t resolution_ = 0;
  std::vector<int32_t> triangles_;
  std::vector<glm::vec3> planned_positions_;

  std::vector<int32_t> carrier_triangle_;
  std::vector<glm::vec2> carrier_weight_;
  /// Way from a flat carrier to the curved surface that the normals tell of.
  std::vector<glm::vec3> curvature_;
  /// 1 or -1: the side of the receiver's faces that snow lies on.
  std::vector<float> side_;
  /// Samples of the map: those of point p from sample_begin_[p].
  std::vector<int32_t> sample_begin_;
  std::vector<int32_t> sample_texel_;
  std::vector<glm::vec2> sample_share_;
  std::vector<float> sample_weight_;
  /// Neighbours of point p from neighbour_begin_[p], with weights by distance.
  std::vector<int32_t> neighbour_begin_;
  std::vector<int32_t> neighbour_;
  std::vector<float> neighbour_weight_;
  /// m2 of the receiver's surface that a point stands for.
  std::vector<float> area_;
  std::vector<shared::SnowPoint> point_;
  /// 1 for points of parts that have no other side.
  std::vector<uint8_t> is_sheet_;
  Cushions cushions_;
  /// Thickness of the snow at the cushions' anchors in the last frame.
  std::vector<float> cushion_height_;
  /// Points in the zones of rims: number, constants, four points behind the rim and their weights.
  std::vector<int32_t> front_point_;
  std::vector<shared::SnowFront> front_;
  /// Metres from their rim to the middle of the top.
  std::vector<float> room_;
  std::vector<glm::ivec4> front_inland_;
  std::vector<glm::vec4> front_weight_;
};

/// Unit normals of points: the mean over their triangles, by area; straight up where there is none.
/// @throws std::invalid_argument for triangles that name no points.
std::vector<glm::vec3> point_normals(const std::vector<glm::vec3>& points,
                                     const std::vector<glm::ivec3>& triangles);

}  // namespace snowbough::snow
