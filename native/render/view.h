#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>

#include "render/sources.h"
#include "shaders/lib/tree_shared.h"

namespace snowbough::render {

/// A camera: a pinhole that is looked through from `eye`, or whatever two matrices say. Metres,
/// radians.
struct Camera {
  glm::vec3 eye{0.0f, -10.0f, 2.0f};
  glm::vec3 target{0.0f, 0.0f, 2.0f};
  glm::vec3 up{0.0f, 0.0f, 1.0f};
  /// Whole angle from the picture's bottom to its top.
  float field_of_view = 0.7f;
  /// What is nearer or farther is not drawn; 0: from the scene's size.
  float near = 0.0f;
  float far = 0.0f;
  /// Pixels.
  int32_t width = 640;
  int32_t height = 480;
  /// Instead of all of the above but the size: OpenGL's matrices from the world to the camera's
  /// space and from there to clip space, in perspective or orthographic, off the axis or not.
  std::optional<glm::mat4> view;
  std::optional<glm::mat4> projection;
  /// Moves the picture, in pixels.
  glm::vec2 jitter{0.0f};
};

enum class Metric : uint8_t {
  /// The thesis's eq. 3.4.1, for comparison with its tables.
  kThesis,
  /// Parts of an edge cover `target_pixels`.
  kScreen,
};

/// Flakes in the air. Metres, seconds.
struct Snowfall {
  /// Depth that falls on open level ground in a second; 0: none are drawn.
  float rate = 0.0f;
  /// In which they fall, downwards; need not be unit.
  glm::vec3 direction{0.0f, 0.0f, -1.0f};
  float speed = 1.2f;
  /// Radians by which they stray.
  float flutter = 0.1745f;
  float radius = 0.004f;
  /// A metre in the scene's units.
  float metre = 1.0f;
  /// How long the picture is exposed: flakes are drawn out by their way in that time.
  float shutter = 1.0f / 100.0f;
  /// Of the picture; the same seed and time give the same flakes.
  float time = 0.0f;
  uint32_t seed = 0;
};

/// How a picture is made.
struct RenderSettings {
  Metric metric = Metric::kScreen;
  /// Most parts of an edge, 1 to 64; 1: everything is plain.
  float max_level = 32.0f;
  /// SCREEN: pixels that a part of an edge covers.
  float target_pixels = 6.0f;
  /// Patches that cover fewer pixels are dropped; 0: none.
  float min_pixels = 0.5f;
  /// THESIS: distance Mtd in metres at which the level has come down to 1, and area Mfa in m2 at
  /// which it is highest (0: the tree's largest patch).
  float max_distance = 80.0f;
  float max_area = 0.0f;
  /// THESIS, of snow on trees: its factor m, parts of a face's edges for each part of the picture's
  /// area that the face covers.
  float snow_factor = 2000.0f;

  /// Lines over white paper, those behind hidden, instead of a shaded picture.
  bool wireframe = false;
  /// Leaves out bark seen from its back.
  bool cull_back_faces = true;
  /// Renders at twice the width and height and takes means.
  bool antialias = false;

  /// Towards the sun; need not be unit.
  glm::vec3 sun_direction{0.4f, -0.6f, 0.7f};
  /// Linear light of the sun on what faces it, of the sky on what faces up, of the ground on what
  /// faces down.
  glm::vec3 sun_color{2.4f, 2.2f, 1.9f};
  glm::vec3 sky_color{0.55f, 0.65f, 0.8f};
  glm::vec3 ground_color{0.2f, 0.19f, 0.18f};
  /// Edge of the shadow map in texels; 0: no shadows.
  int32_t shadow_resolution = 1024;
  /// Of frames: keeps the sun's picture of the frame before where only the camera has moved.
  bool draft = false;
  /// Linear light of what is seen behind everything; none: the sky's.
  std::optional<glm::vec3> background;
  /// Not in wireframes.
  Snowfall snowfall;
};

/// @throws std::invalid_argument naming the value that is out of range.
void check(const SnowDepths& depths);
/// @throws std::invalid_argument naming the value that is out of range.
void check(const Camera& camera, const RenderSettings& settings);

/// A sphere around the trees: what the sun's picture shows, and how far from its centre there may
/// be something to draw.
struct Bounds {
  glm::vec3 centre{0.0f};
  float radius = 1.0f;
  float reach = 1.0f;
};

/// What a picture's passes are told; `camera` of the pixels that are drawn. `linear`: they keep
/// light linear for a target of floats, instead of encoding it as sRGB.
shared::TreeView camera_view(const Camera& camera, const RenderSettings& settings,
                             const Bounds& bounds, bool linear);
/// The same for the sun's picture: its matrix and planes, but the camera's eye, so that the levels
/// are those of the picture.
shared::TreeView sun_view(const shared::TreeView& camera);

}  // namespace snowbough::render
