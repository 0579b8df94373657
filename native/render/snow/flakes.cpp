#include "render/snow/flakes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

namespace snowbough::render {
namespace {

using glm::dvec3;
using glm::vec4;

/// Edge length of the box around the eye in which flakes are drawn, in metres.
constexpr double kBox = 12.0;
/// Volume of lying snow from a flake with a radius of 1 m, in m3. Fresh snow is mostly air.
constexpr double kLaidVolume = 4.18879 * 0.5;
/// Frequency of a flake's flutter, in swings per second.
constexpr float kFlutterRate = 0.7f;
/// Least downward speed of a flake as a fraction of its speed, for slanting falls.
constexpr double kMinSinking = 0.01;

void require(bool right, const char* what) {
  if (!right) throw std::invalid_argument(what);
}

}  // namespace

shared::FlakeFall flake_fall(const Snowfall& fall) {
  const dvec3 direction(fall.direction);
  require(fall.rate >= 0.0f && std::isfinite(fall.rate),
          "snowfall: rate must be 0 or more, and finite");
  require(glm::length(direction) > 0.0 && direction.z <= 0.0,
          "snowfall: direction must point downwards");
  require(fall.speed > 0.0f && fall.speed < 100.0f,
          "snowfall: speed must be over 0 and below 100 m/s");
  require(fall.radius > 0.0f && fall.radius < 0.1f,
          "snowfall: radius must be over 0 and below 0.1 m");
  require(fall.flutter >= 0.0f && fall.flutter <= 0.7854f,
          "snowfall: flutter must be from 0 to pi / 4");
  require(fall.shutter >= 0.0f && fall.shutter <= 1.0f, "snowfall: shutter must be from 0 to 1 s");
  require(fall.metre > 0.0f && std::isfinite(fall.metre),
          "snowfall: metre must be over 0, and finite");
  const dvec3 along = glm::normalize(direction);
  const double sinking = fall.speed * std::max(-along.z, kMinSinking);
  const double laid = kLaidVolume * std::pow(static_cast<double>(fall.radius), 3.0);
  const double flakes = fall.rate / (sinking * laid) * kBox * kBox * kBox;
  dvec3 drift = along * static_cast<double>(fall.speed) * static_cast<double>(fall.time);
  drift -= kBox * glm::floor(drift / kBox);
  // At this width, the path's steepest part has the angle of flutter.
  const double aside = fall.speed * std::tan(static_cast<double>(fall.flutter)) /
                       (2.0 * 3.14159265 * static_cast<double>(kFlutterRate));
  shared::FlakeFall made{};
  made.drift = fall.metre * vec4(glm::vec3(drift), static_cast<float>(kBox));
  made.velocity =
      fall.metre * vec4(glm::vec3(along * static_cast<double>(fall.speed)), fall.radius);
  made.flutter =
      vec4(fall.metre * static_cast<float>(aside), kFlutterRate, fall.shutter, fall.time);
  made.counts = {fall.seed, static_cast<uint32_t>(std::min(std::ceil(flakes), double{kMaxFlakes})),
                 0, 0};
  made.scale = vec4(fall.metre, 0.0f, 0.0f, 0.0f);
  return made;
}

void FlakePass::draw(const Snowfall& fall, const gpu::Buffer& view) {
  const shared::FlakeFall block = flake_fall(fall);
  if (block.counts.y == 0) return;
  block_.write(0, sizeof block, &block);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  program_.use();
  program_.bind("ViewBlock", view);
  program_.bind("FallBlock", block_);
  program_.draw(GL_TRIANGLES, 0, 6 * static_cast<int32_t>(block.counts.y));
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
}

}  // namespace snowbough::render
