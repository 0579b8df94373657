#include "snow/scene/projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>
#include <string>

namespace snowbough::snow {
namespace {

constexpr int32_t kWidestGrid = 65536;
constexpr double kSteepestFall = 89.5 * std::numbers::pi / 180.0;
/// Half the opening angle up to which a cone's directions are about as likely as each other.
constexpr double kWideCone = 0.7854;

double fraction(double value) {
  return value - std::floor(value);
}

/// Number of flutter directions per round, and the stride of a step among them: an order in which
/// parts of a round are spread over the cone, too.
constexpr uint32_t kFlutterRound = 64;
constexpr uint32_t kFlutterStride = 19;

/// splitmix64, for shifts of the sequences from a seed. Source: S. Vigna, public domain.
double shift_of(uint32_t seed, uint32_t dimension) {
  uint64_t z = (uint64_t{seed} << 32 | dimension) + 0x9E3779B97F4A7C15ull;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
}

/// Two axes perpendicular to the fall whose cross product points to the sky.
void grid_axes(const glm::dvec3& direction, glm::dvec3& x, glm::dvec3& y) {
  const glm::dvec3 sky = -direction;
  x = glm::cross(glm::dvec3(0.0, 1.0, 0.0), sky);
  const double length = glm::length(x);
  x = length > 1e-9 ? x / length : glm::dvec3(1.0, 0.0, 0.0);
  y = glm::cross(sky, x);
}

/// The middle of the scene, rounded to an exact float.
glm::vec3 scene_anchor(const Bounds& scene) {
  return scene.empty() ? glm::vec3(0.0f) : glm::vec3((scene.low + scene.high) * 0.5);
}

std::array<glm::dvec3, 8> corners_of(const Bounds& bounds) {
  std::array<glm::dvec3, 8> corners;
  for (size_t i = 0; i < 8; ++i) {
    corners[i] = {i & 1 ? bounds.high.x : bounds.low.x, i & 2 ? bounds.high.y : bounds.low.y,
                  i & 4 ? bounds.high.z : bounds.low.z};
  }
  return corners;
}

}  // namespace

void Bounds::include(const glm::dvec3& point) {
  low = {std::min(low.x, point.x), std::min(low.y, point.y), std::min(low.z, point.z)};
  high = {std::max(high.x, point.x), std::max(high.y, point.y), std::max(high.z, point.z)};
}

void Bounds::include(const Bounds& other) {
  if (!other.empty()) {
    include(other.low);
    include(other.high);
  }
}

glm::dvec2 grid_jitter(uint32_t seed, uint32_t step_number) {
  // 1/p and 1/p^2 of the plastic number p.
  const double n = step_number;
  return {fraction(shift_of(seed, 0) + n * 0.7548776662466927),
          fraction(shift_of(seed, 1) + n * 0.5698402909980532)};
}

glm::dvec2 sample_shift(uint32_t seed, uint32_t step_number) {
  // The fifth and sixth dimension of the R6 sequence.
  const double n = step_number;
  return {fraction(shift_of(seed, 4) + n * 0.5860866975779692),
          fraction(shift_of(seed, 5) + n * 0.5266889867007356)};
}

glm::dvec3 flutter_direction(const glm::dvec3& direction, double flutter, uint32_t seed,
                             uint32_t step_number) {
  const double angle = std::acos(std::clamp(-direction.z, -1.0, 1.0));
  const double room = angle <= kSteepestFall ? kSteepestFall - angle : flutter;
  const double cone = std::min(flutter, room);
  if (cone <= 0.0) {
    return direction;
  }
  const uint32_t round = step_number / kFlutterRound;
  const auto first = static_cast<uint32_t>(shift_of(seed, 2) * kFlutterRound);
  const double seed_number = (first + step_number * kFlutterStride) % kFlutterRound;
  // Every round is shifted by the R2 sequence.
  const double within = fraction(0.5 + round * 0.7548776662466927);
  const double share = (seed_number + within) / kFlutterRound;
  const double turn =
      fraction(shift_of(seed, 3) + seed_number * std::numbers::phi + round * 0.5698402909980532);
  // Uniform over the cone's solid angle.
  double cosine = 1.0 - share * (1.0 - std::cos(cone));
  if (cone > kWideCone) {
    // Each direction counts by its upward part, so that the whole sky covers level ground as the
    // light of an even sky does. A direction stands for a part of the sky, in which what walls get
    // is 1 / cosine on average.
    const double spread = std::sin(cone);
    const auto edge = [&](double number) {
      return std::sqrt(1.0 - number / kFlutterRound * spread * spread);
    };
    cosine = 0.5 * (edge(seed_number) + edge(seed_number + 1.0));
  }
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  const double phi = 2.0 * std::numbers::pi * turn;
  glm::dvec3 x;
  glm::dvec3 y;
  grid_axes(direction, x, y);
  return glm::normalize(direction * cosine + (x * std::cos(phi) + y * std::sin(phi)) * sine);
}

shared::ProjectionFrame make_projection_frame(const FallSettings& settings, const Bounds& scene) {
  const glm::dvec3 direction =
      flutter_direction(settings.direction, settings.flutter, settings.seed, settings.step_number);
  glm::dvec3 x;
  glm::dvec3 y;
  grid_axes(direction, x, y);
  const glm::vec3 anchor = scene_anchor(scene);
  const glm::dvec2 jitter = grid_jitter(settings.seed, settings.step_number);
  const glm::dvec2 place(glm::dot(glm::dvec3(anchor), x) / settings.pixel_size + jitter.x,
                         glm::dot(glm::dvec3(anchor), y) / settings.pixel_size + jitter.y);
  const glm::dvec2 base(std::floor(place.x), std::floor(place.y));

  double nearest = 0.0;
  double farthest = 1.0;
  if (!scene.empty()) {
    nearest = 1e300;
    farthest = -1e300;
    for (const glm::dvec3& corner : corners_of(scene)) {
      const double depth = glm::dot(corner - glm::dvec3(anchor), direction);
      nearest = std::min(nearest, depth);
      farthest = std::max(farthest, depth);
    }
  }
  const double spare = std::max((farthest - nearest) * 1e-3, settings.pixel_size);
  nearest -= spare;
  farthest += spare;

  shared::ProjectionFrame frame;
  frame.anchor = glm::vec4(anchor, 0.0f);
  frame.sampling =
      glm::vec4(glm::vec2(sample_shift(settings.seed, settings.step_number)), 0.0f, 0.0f);
  frame.grid_x = glm::vec4(glm::vec3(x / settings.pixel_size), place.x - base.x);
  frame.grid_y = glm::vec4(glm::vec3(y / settings.pixel_size), place.y - base.y);
  frame.direction = glm::vec4(glm::vec3(direction), settings.pixel_size);
  frame.range = {nearest, 1.0 / (farthest - nearest),
                 settings.depth / std::max(std::abs(direction.z), 0.01), settings.noise_density};
  // Only the hash uses it, so overflow far from the origin is harmless.
  frame.base = {static_cast<int32_t>(static_cast<uint32_t>(static_cast<int64_t>(base.x))),
                static_cast<int32_t>(static_cast<uint32_t>(static_cast<int64_t>(base.y)))};
  frame.seed = settings.seed;
  frame.step_number = settings.step_number;
  return frame;
}

PixelRect pixels_of(const Bounds& bounds, const shared::ProjectionFrame& frame) {
  const glm::vec2 anchor = shared::anchor_pixel(frame);
  glm::dvec2 low(1e300);
  glm::dvec2 high(-1e300);
  for (const glm::dvec3& corner : corners_of(bounds)) {
    const glm::dvec3 offset = corner - glm::dvec3(glm::vec3(frame.anchor));
    const glm::dvec2 at(glm::dot(offset, glm::dvec3(glm::vec3(frame.grid_x))) + anchor.x,
                        glm::dot(offset, glm::dvec3(glm::vec3(frame.grid_y))) + anchor.y);
    low = {std::min(low.x, at.x), std::min(low.y, at.y)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y)};
  }
  const auto whole = [](double value) {
    return static_cast<int32_t>(std::floor(std::clamp(value, -1e9, 1e9)));
  };
  return {{whole(low.x) - 1, whole(low.y) - 1}, {whole(high.x) + 2, whole(high.y) + 2}};
}

std::vector<Tile> make_tiles(const std::vector<PixelRect>& receivers, int32_t tile_size) {
  std::vector<Tile> tiles;
  if (receivers.empty()) {
    return tiles;
  }
  PixelRect all = receivers.front();
  for (const PixelRect& rect : receivers) {
    all.low = {std::min(all.low.x, rect.low.x), std::min(all.low.y, rect.low.y)};
    all.high = {std::max(all.high.x, rect.high.x), std::max(all.high.y, rect.high.y)};
  }
  if (all.size().x > kWidestGrid || all.size().y > kWidestGrid) {
    throw std::invalid_argument("the receivers span " +
                                std::to_string(std::max(all.size().x, all.size().y)) +
                                " pixels; the maximum is " + std::to_string(kWidestGrid) +
                                ": use a larger pixel_size, or leave far-away receivers out");
  }
  const auto block_of = [](int32_t pixel) {
    return static_cast<int32_t>(
        std::floor((static_cast<double>(pixel) + kBlockSize / 2.0) / kBlockSize));
  };
  for (int32_t by = block_of(all.low.y); by <= block_of(all.high.y - 1); ++by) {
    for (int32_t bx = block_of(all.low.x); bx <= block_of(all.high.x - 1); ++bx) {
      const glm::ivec2 block(bx * kBlockSize - kBlockSize / 2, by * kBlockSize - kBlockSize / 2);
      const glm::ivec2 low(std::max(block.x, all.low.x), std::max(block.y, all.low.y));
      const glm::ivec2 high(std::min(block.x + kBlockSize, all.high.x),
                            std::min(block.y + kBlockSize, all.high.y));
      for (int32_t y = low.y; y < high.y; y += tile_size) {
        for (int32_t x = low.x; x < high.x; x += tile_size) {
          // Shrunk to the receivers inside: empty sky needs no rendering.
          PixelRect shown{{high.x, high.y}, {low.x, low.y}};
          for (const PixelRect& rect : receivers) {
            const glm::ivec2 a(std::max(rect.low.x, x), std::max(rect.low.y, y));
            const glm::ivec2 b(std::min({rect.high.x, x + tile_size, high.x}),
                               std::min({rect.high.y, y + tile_size, high.y}));
            if (a.x < b.x && a.y < b.y) {
              shown.low = {std::min(shown.low.x, a.x), std::min(shown.low.y, a.y)};
              shown.high = {std::max(shown.high.x, b.x), std::max(shown.high.y, b.y)};
            }
          }
          if (!shown.empty()) {
            tiles.push_back({shown, block - glm::ivec2(kBlockSize / 2)});
          }
        }
      }
    }
  }
  return tiles;
}

}  // namespace snowbough::snow
