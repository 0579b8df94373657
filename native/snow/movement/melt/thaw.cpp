#include "snow/movement/melt/thaw.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>

#include "base/parallel_for.h"
#include "snow/movement/melt/linked_runs.h"

namespace snowbough::snow {
namespace {

/// Texels that a thread computes at a time.
constexpr size_t kTexelRun = 4096;
/// Waves of the noise: their length in metres and their share.
constexpr float kWaves[][2] = {{0.45f, 0.88f}, {0.17f, 0.60f}, {0.07f, 0.32f}};
/// Distance in metres within which bare ground melts snow, by how much faster for each part of
/// unevenness, and the thickness in metres below which ground counts as bare.
constexpr double kNearBare = 0.10;
constexpr double kBareMelts = 6.0;
constexpr float kBareDepth = 0.002f;
constexpr int32_t kMostRadius = 32;
/// Bounds of the factors.
constexpr float kLeastFactor = 0.05f;
constexpr float kMostLight = 4.0f;
/// Thinner snow vanishes, in metres.
constexpr float kVanishes = 1e-5f;

/// A number from -1 to 1 at a point of a lattice (finaliser of splitmix64, G. Steele, D. Lea,
/// C. Flood, Fast splittable pseudorandom number generators, 2014).
float lattice_value(int64_t x, int64_t y, int64_t z, uint64_t wave) {
  uint64_t h = wave * 0x9E3779B97F4A7C15u;
  for (const int64_t part : {x, y, z}) {
    h ^= static_cast<uint64_t>(part) + 0x9E3779B97F4A7C15u;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9u;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBu;
    h ^= h >> 31;
  }
  return static_cast<float>(static_cast<double>(h >> 40) * 0x1p-23 - 1.0);
}

/// Smooth noise from -1 to 1, whose waves are 1 long.
float noise_at(const glm::dvec3& at, uint64_t wave) {
  const glm::dvec3 cell = glm::floor(at);
  glm::dvec3 part = at - cell;
  part = part * part * (3.0 - 2.0 * part);
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 offset(corner & 1, corner >> 1 & 1, corner >> 2);
    const glm::dvec3 weight = offset * part + (1.0 - offset) * (1.0 - part);
    const glm::dvec3 place = cell + offset;
    sum += weight.x * weight.y * weight.z *
           static_cast<double>(lattice_value(static_cast<int64_t>(place.x),
                                             static_cast<int64_t>(place.y),
                                             static_cast<int64_t>(place.z), wave));
  }
  return static_cast<float>(sum);
}

}  // namespace

void Thaw::lay_out(const std::vector<const SceneObject*>& objects) {
  objects_ = objects;
  noise_.assign(objects.size(), {});
  runs_.clear();
  runs_.resize(objects.size());
}

const std::vector<float>& Thaw::noise_of(size_t object) {
  std::vector<float>& noise = noise_[object];
  if (!noise.empty()) return noise;
  const ObjectDescription& description = objects_[object]->description;
  const TexelTable& table = *objects_[object]->table;
  noise.resize(table.texel.size());
  base::for_each_item(noise.size(), kTexelRun, [&](size_t i) {
    const int32_t* const corner =
        &description.topology.triangles[3 * static_cast<size_t>(table.triangle[i])];
    const glm::vec2 weight = table.barycentric[i];
    const auto point = [&](size_t k) {
      return glm::dvec3(description.rest[static_cast<size_t>(corner[k])]);
    };
    const glm::dvec3 at = point(0) * (1.0 - static_cast<double>(weight.x + weight.y)) +
                          point(1) * static_cast<double>(weight.x) +
                          point(2) * static_cast<double>(weight.y);
    float sum = 0.0f;
    uint64_t wave = 1;
    for (const auto& [length, share] : kWaves) {
      sum += share * noise_at(at / static_cast<double>(length), wave++);
    }
    noise[i] = sum;
  });
  return noise;
}

const LinkedRuns& Thaw::runs_of(size_t object, Repose& repose) {
  if (runs_[object] == nullptr) {
    runs_[object] = std::make_unique<LinkedRuns>(*objects_[object]->table, *repose.ground().links);
  }
  return *runs_[object];
}

const std::vector<float>& Thaw::melt(const MeltSettings& settings, const std::vector<float>* light,
                                     MovingMap& map, Repose& repose) {
  melted_.clear();
  if (!(settings.depth > 0.0)) return melted_;
  const std::vector<int32_t>& places = objects_[map.object]->table->texel;
  const BareTexels& bare = repose.bare();
  const auto thickness = [&](size_t i) {
    return std::abs((*map.height)[static_cast<size_t>(places[i])]);
  };
  std::vector<float>& bareness = bareness_;
  bareness.assign(settings.unevenness > 0.0 ? places.size() : 0, 0.0f);
  size_t covered = 0;
  size_t bare_ones = 0;
  for (size_t i = 0; i < places.size(); ++i) {
    const float own = thickness(i);
    covered += own > 0.0f ? 1 : 0;
    if (bareness.empty() || own >= kBareDepth) continue;
    bareness[i] = 1.0f;
    ++bare_ones;
  }
  if (covered == 0) return melted_;
  const std::vector<float>* noise = nullptr;
  if (!bareness.empty()) {
    double area = 0.0;
    for (const float own : bare.area) area += static_cast<double>(own);
    const double texel = std::sqrt(area / static_cast<double>(places.size()));
    const auto radius = static_cast<int32_t>(
        std::clamp(std::round(kNearBare / texel), 1.0, static_cast<double>(kMostRadius)));
    if (bare_ones > 0) runs_of(map.object, repose).average(radius, bareness);
    noise = &noise_of(map.object);
  }
  const double sun = settings.sun_share;
  std::vector<float>& melted = melted_;
  melted.assign(places.size(), 0.0f);
  std::vector<double> volumes((places.size() + kTexelRun - 1) / kTexelRun, 0.0);
  base::for_each_item(volumes.size(), 1, [&](size_t run) {
    const size_t end = std::min(places.size(), (run + 1) * kTexelRun);
    for (size_t i = run * kTexelRun; i < end; ++i) {
      float& height = (*map.height)[static_cast<size_t>(places[i])];
      if (height == 0.0f) continue;
      const float shines = light == nullptr ? 0.0f : (*light)[static_cast<size_t>(places[i])];
      double loss =
          settings.depth * (1.0 - sun + sun * static_cast<double>(std::min(shines, kMostLight)));
      if (noise != nullptr) {
        loss *= std::max(1.0 + settings.unevenness * static_cast<double>((*noise)[i]),
                         static_cast<double>(kLeastFactor));
        loss *= 1.0 + kBareMelts * settings.unevenness * static_cast<double>(bareness[i]);
      }
      const float before = std::abs(height);
      auto left = static_cast<float>(std::max(static_cast<double>(before) - loss, 0.0));
      if (left < kVanishes) left = 0.0f;
      if (!(left < before)) continue;
      height = left > 0.0f ? std::copysign(left, height) : 0.0f;
      melted[i] = before - left;
      volumes[run] += (static_cast<double>(before) - static_cast<double>(left)) *
                      static_cast<double>(bare.area[i]);
    }
  });
  for (const double volume : volumes) {
    map.melted += volume;
    map.has_changed = map.has_changed || volume > 0.0;
  }
  return melted_;
}

}  // namespace snowbough::snow
