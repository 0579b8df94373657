#include "snow/movement/melt/thaw.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/ext/vector_int3_sized.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

#include "base/parallel_for.h"
#include "base/simd.h"
#include "snow/movement/melt/linked_runs.h"
#include "snow/movement/melt/texel_runs.h"

namespace snowbough::snow {
namespace {

/// Waves of the noise: their length in metres and their share.
constexpr float kWaves[][2] = {{0.45f, 0.88f}, {0.17f, 0.60f}, {0.07f, 0.32f}};
/// Distance in metres within which bare ground melts snow, by how much faster for each part of
/// unevenness, and the thickness in metres below which ground counts as bare.
constexpr double kNearBare = 0.10;
constexpr double kBareMelts = 6.0;
constexpr float kBareDepth = 0.002f;
constexpr int32_t kMaxRadius = 32;
/// Bounds of the factors.
constexpr float kMinFactor = 0.05f;
constexpr float kMaxLight = 4.0f;
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
class Noise {
 public:
  explicit Noise(uint64_t wave) : wave_(wave) {}

  float at(const glm::dvec3& point) {
    const glm::dvec3 cell = glm::floor(point);
    if (cell != cell_) find_corners(cell);
    glm::dvec3 part = point - cell;
    part = part * part * (3.0 - 2.0 * part);
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 offset(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::dvec3 weight = offset * part + (1.0 - offset) * (1.0 - part);
      sum += weight.x * weight.y * weight.z *
             static_cast<double>(corners_[static_cast<size_t>(corner)]);
    }
    return static_cast<float>(sum);
  }

 private:
  /// Neighbours mostly lie in the same cell.
  void find_corners(const glm::dvec3& cell) {
    cell_ = cell;
    const glm::i64vec3 first(cell);
    for (int corner = 0; corner < 8; ++corner) {
      corners_[static_cast<size_t>(corner)] = lattice_value(
          first.x + (corner & 1), first.y + (corner >> 1 & 1), first.z + (corner >> 2), wave_);
    }
  }

  uint64_t wave_;
  glm::dvec3 cell_{std::numeric_limits<double>::infinity()};
  std::array<float, 8> corners_{};
};

/// Counts texels with snow, and with so little that they count as bare.
struct Cover {
  uint32_t covered = 0, bare = 0;
};
SNOWBOUGH_WIDE Cover find_cover(const float* height, size_t count) {
  Cover cover;
  for (size_t i = 0; i < count; ++i) {
    const float own = std::abs(height[i]);
    cover.covered += own > 0.0f ? 1u : 0u;
    cover.bare += own < kBareDepth ? 1u : 0u;
  }
  return cover;
}

/// Marks bare texels with 1.
SNOWBOUGH_WIDE void mark_bare(const float* __restrict height, size_t count,
                              float* __restrict bareness) {
  for (size_t i = 0; i < count; ++i) bareness[i] = std::abs(height[i]) < kBareDepth ? 1.0f : 0.0f;
}

/// The volume of a run of texels.
SNOWBOUGH_WIDE double volume_of(const float* thickness, const float* area, size_t count) {
  constexpr size_t kLanes = 8;
  std::array<double, kLanes> sums{};
  const size_t whole = count / kLanes * kLanes;
  for (size_t i = 0; i < whole; i += kLanes) {
    for (size_t k = 0; k < kLanes; ++k) {
      sums[k] += static_cast<double>(thickness[i + k]) * static_cast<double>(area[i + k]);
    }
  }
  for (size_t i = whole; i < count; ++i) {
    sums[0] += static_cast<double>(thickness[i]) * static_cast<double>(area[i]);
  }
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// How a run of texels melts: see Thaw. Planes by texel, and of the map; null: of no effect.
struct MeltRun {
  double depth, sun, unevenness;
  const float* light;
  const float* noise;
  const float* bareness;
};

/// Melts snow; `melted`: by how much each texel becomes thinner, in metres.
template <bool kSun, bool kUneven, bool kBare>
inline void melt_texels(const MeltRun& run, size_t count, float* __restrict height,
                        float* __restrict melted) {
  const float* __restrict const light = run.light;
  const float* __restrict const noise = run.noise;
  const float* __restrict const bareness = run.bareness;
  for (size_t i = 0; i < count; ++i) {
    const float shines = kSun ? std::min(light[i], kMaxLight) : 0.0f;
    double loss = run.depth * (1.0 - run.sun + run.sun * static_cast<double>(shines));
    if (kUneven) {
      loss *= std::max(1.0 + run.unevenness * static_cast<double>(noise[i]),
                       static_cast<double>(kMinFactor));
      if (kBare) loss *= 1.0 + kBareMelts * run.unevenness * static_cast<double>(bareness[i]);
    }
    const float before = std::abs(height[i]);
    const auto wanted = static_cast<float>(std::max(static_cast<double>(before) - loss, 0.0));
    const float thin = wanted < kVanishes ? 0.0f : wanted;
    const float left = std::min(thin, before);
    melted[i] = before - left;
    height[i] = left > 0.0f ? std::copysign(left, height[i]) : 0.0f;
  }
}

template <bool kSun>
inline void melt_lit(const MeltRun& run, size_t count, float* height, float* melted) {
  if (run.noise == nullptr) return melt_texels<kSun, false, false>(run, count, height, melted);
  run.bareness == nullptr ? melt_texels<kSun, true, false>(run, count, height, melted)
                          : melt_texels<kSun, true, true>(run, count, height, melted);
}

SNOWBOUGH_WIDE_FLAT void melt_run(const MeltRun& run, size_t count, float* height, float* melted) {
  run.light != nullptr ? melt_lit<true>(run, count, height, melted)
                       : melt_lit<false>(run, count, height, melted);
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
  const auto find = [&](size_t i, std::vector<Noise>& waves) {
    const int32_t* const corner =
        &description.topology.triangles[3 * static_cast<size_t>(table.triangle[i])];
    const glm::vec2 weight = table.barycentric[i];
    const auto point = [&](size_t k) {
      return glm::dvec3(description.rest[static_cast<size_t>(corner[k])]);
    };
    const glm::dvec3 at = point(0) * (1.0 - static_cast<double>(weight.x + weight.y)) +
                          point(1) * static_cast<double>(weight.x) +
                          point(2) * static_cast<double>(weight.y);
    for (size_t k = 0; k < waves.size(); ++k) {
      const auto& [length, share] = kWaves[k];
      noise[i] += share * waves[k].at(at / static_cast<double>(length));
    }
  };
  base::for_each_item((noise.size() + kTexelRun - 1) / kTexelRun, 1, [&](size_t run) {
    std::vector<Noise> waves;
    for (size_t k = 0; k < std::size(kWaves); ++k) waves.emplace_back(k + 1);
    const size_t end = std::min(noise.size(), (run + 1) * kTexelRun);
    for (size_t i = run * kTexelRun; i < end; ++i) find(i, waves);
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
  std::vector<float>& heights = *map.height;
  const size_t count = places.size();
  std::vector<Cover> covers((count + kTexelRun - 1) / kTexelRun);
  for_texel_runs(places, [&](size_t texel, size_t place, size_t texels) {
    const Cover own = find_cover(&heights[place], texels);
    covers[texel / kTexelRun].covered += own.covered;
    covers[texel / kTexelRun].bare += own.bare;
  });
  const auto any = [&](uint32_t Cover::*texels) {
    return std::any_of(covers.begin(), covers.end(),
                       [&](const Cover& cover) { return cover.*texels > 0; });
  };
  if (!any(&Cover::covered)) return melted_;
  const std::vector<float>* noise = nullptr;
  const bool is_near_bare = settings.unevenness > 0.0 && any(&Cover::bare);
  if (settings.unevenness > 0.0) noise = &noise_of(map.object);
  if (is_near_bare) {
    const double texel = std::sqrt(bare.whole_area / static_cast<double>(count));
    const auto radius = static_cast<int32_t>(
        std::clamp(std::round(kNearBare / texel), 1.0, static_cast<double>(kMaxRadius)));
    bareness_.resize(count);
    for_texel_runs(places, [&](size_t texel_begin, size_t place, size_t texels) {
      mark_bare(&heights[place], texels, &bareness_[texel_begin]);
    });
    runs_of(map.object, repose).average(radius, bareness_);
  }
  if (settings.is_wet) melted_.resize(count);
  std::vector<double> volumes(covers.size(), 0.0);
  for_texel_runs(places, [&](size_t texel, size_t place, size_t texels) {
    std::array<float, kTexelRun> only_here;
    float* const melted = settings.is_wet ? &melted_[texel] : only_here.data();
    melt_run(
        {settings.depth, settings.sun_share, settings.unevenness,
         light != nullptr ? &(*light)[place] : nullptr,
         noise != nullptr ? &(*noise)[texel] : nullptr, is_near_bare ? &bareness_[texel] : nullptr},
        texels, &heights[place], melted);
    volumes[texel / kTexelRun] += volume_of(melted, &bare.area[texel], texels);
  });
  for (const double volume : volumes) {
    map.melted += volume;
    map.has_changed = map.has_changed || volume > 0.0;
  }
  return melted_;
}

}  // namespace snowbough::snow
