#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "render/data/sources.h"
#include "shaders/lib/tree_shared.h"

namespace snowbough::render {

/// A camera: a pinhole at `eye`, or two arbitrary matrices. Metres, radians.
struct Camera {
  glm::vec3 eye{0.0f, -10.0f, 2.0f};
  glm::vec3 target{0.0f, 0.0f, 2.0f};
  glm::vec3 up{0.0f, 0.0f, 1.0f};
  /// Full vertical angle.
  float field_of_view = 0.7f;
  /// Clipping distances; 0: computed from the size of the scene.
  float near = 0.0f;
  float far = 0.0f;
  /// Pixels.
  int32_t width = 640;
  int32_t height = 480;
  /// If set, these OpenGL matrices replace all values above except the size: from the world to the
  /// camera's space, and from there to clip space. The projection may be perspective or
  /// orthographic, and off-axis.
  std::optional<glm::mat4> view;
  std::optional<glm::mat4> projection;
  /// Shift of the picture in pixels.
  glm::vec2 jitter{0.0f};
};

enum class Metric : uint8_t {
  /// Eq. 3.4.1 of the thesis, for comparison with its tables.
  kThesis,
  /// Each segment of an edge covers `target_pixels` pixels.
  kScreen,
};

/// Falling flakes. Metres, seconds.
struct Snowfall {
  /// Depth that falls on open level ground per second; 0 draws no flakes.
  float rate = 0.0f;
  /// Direction of the fall, downwards; any length.
  glm::vec3 direction{0.0f, 0.0f, -1.0f};
  float speed = 1.2f;
  /// Greatest angle of flutter, in radians.
  float flutter = 0.1745f;
  float radius = 0.004f;
  /// Length of a metre in the scene's units.
  float metre = 1.0f;
  /// Exposure time; flakes are drawn as streaks along their path in that time.
  float shutter = 1.0f / 100.0f;
  /// Time of the picture; the same seed and time give the same flakes.
  float time = 0.0f;
  uint32_t seed = 0;
};

/// Settings of a picture.
struct RenderSettings {
  Metric metric = Metric::kScreen;
  /// Highest tessellation level, 1 to 64; at 1 all patches are plain.
  float max_level = 32.0f;
  /// SCREEN: length of an edge's segments, in pixels.
  float target_pixels = 6.0f;
  /// SCREEN: least width of a limb in pixels: some thinner limbs are dropped, and the others grow
  /// to it. 0: all limbs are drawn as they are.
  float min_pixels = 0.7f;
  /// THESIS: distance Mtd in metres at which the level has fallen to 1, and area Mfa in m2 with the
  /// highest level (0: the area of the tree's largest patch).
  float max_distance = 80.0f;
  float max_area = 0.0f;
  /// THESIS, for snow on trees: its factor m, the edge level of a face divided by the fraction of
  /// the picture that the face covers.
  float snow_factor = 2000.0f;

  /// Draws a wireframe with hidden lines removed on white, instead of a shaded picture.
  bool wireframe = false;
  /// Does not draw back faces of bark.
  bool cull_back_faces = true;
  /// Renders at twice the width and height and averages 2 x 2 pixels.
  bool antialias = false;

  /// Direction towards the sun; any length.
  glm::vec3 sun_direction{0.4f, -0.6f, 0.7f};
  /// Linear light of the sun on a surface that faces it, of the sky on one that faces up, and of
  /// the ground on one that faces down.
  glm::vec3 sun_color{2.4f, 2.2f, 1.9f};
  glm::vec3 sky_color{0.55f, 0.65f, 0.8f};
  glm::vec3 ground_color{0.2f, 0.19f, 0.18f};
  /// Side of the shadow map in texels; 0 draws no shadows.
  int32_t shadow_resolution = 1024;
  /// For requested frames: reuses the shadow map of the previous frame if only the camera has
  /// moved.
  bool draft = false;
  /// Linear light of the background; if empty, the sky's.
  std::optional<glm::vec3> background;
  /// Not drawn in wireframes.
  Snowfall snowfall;
};

/// @throws std::invalid_argument naming the value that is out of range.
void check(const SnowLook& look);
/// @throws std::invalid_argument naming the value that is out of range.
void check(const Camera& camera, const RenderSettings& settings);

/// A sphere around the trees, which the shadow map covers, and the greatest distance of drawn
/// objects from its centre.
struct Bounds {
  glm::vec3 centre{0.0f};
  float radius = 1.0f;
  float reach = 1.0f;
};

/// The uniform block of a picture's passes. The camera's size is that of the drawn pixels.
/// `linear`: the target is a float format and keeps linear light instead of sRGB.
shared::TreeView camera_view(const Camera& camera, const RenderSettings& settings,
                             const Bounds& bounds, bool linear);
/// The uniform block of the shadow map: its own matrix and planes, but the camera's eye, so that
/// the tessellation levels equal those of the picture.
shared::TreeView sun_view(const shared::TreeView& camera);

}  // namespace snowbough::render
