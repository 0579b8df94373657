#include "render/data/view.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <stdexcept>

namespace snowbough::render {
namespace {

using glm::mat4;
using glm::vec3;
using glm::vec4;

void check_range(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    throw std::invalid_argument(std::string(name) + " must be from " + std::to_string(low) +
                                " to " + std::to_string(high) + ", not " + std::to_string(value));
  }
}

/// Sets the six clipping planes, with unit normals, from the clip matrix: clip coordinates lie
/// between -w and w.
void put_planes(const mat4& clip, shared::TreeView& view) {
  const mat4 rows = glm::transpose(clip);
  for (int k = 0; k < 6; ++k) {
    const vec4 plane = rows[3] + (k % 2 == 0 ? rows[k / 2] : -rows[k / 2]);
    view.planes[k] = plane / glm::length(vec3(plane));
  }
}

vec3 any_across(const vec3& direction) {
  const vec3 other = std::abs(direction.z) < 0.9f ? vec3(0.0f, 0.0f, 1.0f) : vec3(0.0f, 1.0f, 0.0f);
  return glm::normalize(glm::cross(direction, other));
}

mat4 sun_matrix(const vec3& to_sun, const Bounds& bounds) {
  const float r = bounds.radius;
  const mat4 look =
      glm::lookAt(bounds.centre + 2.0f * r * to_sun, bounds.centre, any_across(to_sun));
  return glm::ortho(-r, r, -r, r, r, 3.0f * r) * look;
}

void check_matrix(const char* name, const mat4& matrix) {
  const float of = glm::determinant(matrix);
  if (!std::isfinite(of) || of == 0.0f) {
    throw std::invalid_argument(std::string("the camera's ") + name + " matrix has no inverse");
  }
}

void look_from_eye(const Camera& camera, const Bounds& bounds, shared::TreeView& view) {
  const float to_centre = glm::distance(camera.eye, bounds.centre);
  const float far =
      camera.far > 0.0f ? camera.far : std::max(to_centre + 20.0f * bounds.radius, 1e-3f);
  const float near =
      camera.near > 0.0f ? camera.near : std::max(to_centre - 1.2f * bounds.reach, 1e-4f * far);
  const float aspect = static_cast<float>(camera.width) / static_cast<float>(camera.height);
  view.clip_from_world =
      glm::perspective(camera.field_of_view, aspect, std::min(near, 0.5f * far), far) *
      glm::lookAt(camera.eye, camera.target, camera.up);
  const float pixels =
      static_cast<float>(camera.height) / (2.0f * std::tan(0.5f * camera.field_of_view));
  view.eye = vec4(camera.eye, pixels);
  view.viewer = vec4(camera.eye, 1.0f);
}

/// Distance of an orthographic camera's eye in radii of the scene. The passes use distances only,
/// which hardly differ from so far away.
constexpr float kOrthographicEye = 1e3f;

void look_through_matrices(const Camera& camera, const Bounds& bounds, shared::TreeView& view) {
  const mat4& projection = *camera.projection;
  view.clip_from_world = projection * *camera.view;
  const mat4 world_from_camera = glm::inverse(*camera.view);
  float pixels = 0.5f * static_cast<float>(camera.height) * std::abs(projection[1][1]);
  vec3 eye = vec3(world_from_camera[3]);
  view.viewer = vec4(eye, 1.0f);
  if (projection[2][3] == 0.0f) {
    const float away = kOrthographicEye * bounds.radius;
    const vec3 back = glm::normalize(vec3(world_from_camera[2]));
    view.viewer = vec4(back, 0.0f);
    eye = bounds.centre + away * back;
    pixels *= away;
  }
  view.eye = vec4(eye, pixels);
}

}  // namespace

void check(const SnowLook& look) {
  check_range("open_depth", look.open, 0.0, 1e6);
  check_range("last_depth", look.last, 1e-6, 1e6);
}

void check(const Camera& camera, const RenderSettings& settings) {
  check_range("width", camera.width, 1, 8192);
  check_range("height", camera.height, 1, 8192);
  check_range("field_of_view", camera.field_of_view, 1e-4, 3.1);
  check_range("near", camera.near, 0.0, 1e9);
  check_range("max_level", settings.max_level, 1.0, 64.0);
  check_range("target_pixels", settings.target_pixels, 0.25, 1e6);
  check_range("min_pixels", settings.min_pixels, 0.0, 1e6);
  check_range("max_distance", settings.max_distance, 1e-6, 1e9);
  check_range("max_area", settings.max_area, 0.0, 1e9);
  check_range("snow_factor", settings.snow_factor, 0.0, 1e9);
  check_range("shadow_resolution", settings.shadow_resolution, 0, 8192);
  if (camera.far != 0.0f && !(camera.far > camera.near)) {
    throw std::invalid_argument("far must be greater than near, or 0");
  }
  if (camera.view.has_value() != camera.projection.has_value()) {
    throw std::invalid_argument(
        "a camera must have both a view and a projection matrix, or neither");
  }
  if (camera.view) {
    check_matrix("view", *camera.view);
    check_matrix("projection", *camera.projection);
  }
  const vec3 forward = camera.target - camera.eye;
  if (!camera.view && !(glm::length(glm::cross(forward, camera.up)) >
                        1e-6f * glm::length(forward) * glm::length(camera.up))) {
    throw std::invalid_argument(
        "eye and target must differ, and up must not be parallel to the line between them");
  }
  if (!(glm::length(settings.sun_direction) > 0.0f)) {
    throw std::invalid_argument("sun_direction must not be zero");
  }
}

shared::TreeView camera_view(const Camera& camera, const RenderSettings& settings,
                             const Bounds& bounds, bool linear) {
  shared::TreeView view{};
  if (camera.view) {
    look_through_matrices(camera, bounds, view);
  } else {
    look_from_eye(camera, bounds, view);
  }
  const vec3 shift(2.0f * camera.jitter.x / static_cast<float>(camera.width),
                   2.0f * camera.jitter.y / static_cast<float>(camera.height), 0.0f);
  view.clip_from_world = glm::translate(mat4(1.0f), shift) * view.clip_from_world;
  put_planes(view.clip_from_world, view);
  view.tessellation =
      vec4(settings.metric == Metric::kThesis ? static_cast<float>(shared::kMetricThesis)
                                              : static_cast<float>(shared::kMetricScreen),
           settings.max_level, settings.target_pixels, settings.min_pixels);
  view.thesis = vec4(settings.max_distance, settings.max_area, 0.0f,
                     settings.metric == Metric::kThesis ? 1.0f : 0.0f);
  const vec3 to_sun = glm::normalize(settings.sun_direction);
  view.shadow_from_world = sun_matrix(to_sun, bounds);
  view.sun_direction = vec4(to_sun, settings.shadow_resolution > 0 ? 1.0f : 0.0f);
  view.sun_color = vec4(settings.sun_color, 1.0f);
  view.sky_color = vec4(settings.sky_color, linear ? 1.0f : 0.0f);
  view.ground_color = vec4(settings.ground_color, 1.0f);
  const bool drops_backs =
      settings.cull_back_faces && settings.metric == Metric::kScreen && settings.min_pixels > 0.0f;
  view.snow = vec4(settings.snow_factor, 0.0f, 0.0f, drops_backs ? 1.0f : 0.0f);
  return view;
}

shared::TreeView sun_view(const shared::TreeView& camera) {
  shared::TreeView view = camera;
  view.clip_from_world = camera.shadow_from_world;
  view.viewer = vec4(vec3(camera.sun_direction), 0.0f);
  put_planes(view.clip_from_world, view);
  return view;
}

}  // namespace snowbough::render
