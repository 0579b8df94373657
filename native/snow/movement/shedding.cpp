#include "snow/movement/shedding.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "base/parallel_for.h"
#include "snow/movement/hashed.h"

namespace snowbough::snow {
namespace {

/// The edge of a cube in depths of the snow, before it is rounded up to a power of two; and the
/// smallest and largest one in metres.
constexpr double kDepths = 2.0;
constexpr double kSmallestCube = 0.015625;
constexpr double kLargestCube = 0.5;
/// For numbers that differ from those of other passes.
constexpr uint64_t kShedSalt = 3;

/// The edge of the cubes on a map, in metres.
double cube_of(const std::vector<float>& heights) {
  double sum = 0.0;
  int64_t count = 0;
  for (const float height : heights) {
    sum += static_cast<double>(std::abs(height));
    count += height != 0.0f ? 1 : 0;
  }
  const double edge = kDepths * sum / static_cast<double>(std::max<int64_t>(count, 1));
  return std::clamp(std::exp2(std::ceil(std::log2(std::max(edge, 1e-9)))), kSmallestCube,
                    kLargestCube);
}

}  // namespace

void Shedding::lay_out(const std::vector<const SceneObject*>& objects) {
  objects_ = objects;
}

bool Shedding::is_on() const {
  return std::any_of(objects_.begin(), objects_.end(), [](const SceneObject* object) {
    return object->description.receive && object->shed_half_life > 0.0;
  });
}

void Shedding::shed(uint32_t step_number, double dt, MovingMap& map, Repose& repose) {
  const SceneObject& object = *objects_[map.object];
  const double half_life = object.shed_half_life;
  if (!(half_life > 0.0) || !(dt > 0.0)) return;
  const double share = -std::expm1(-dt / half_life * std::log(2.0));
  const double edge = cube_of(*map.height);
  const TexelTable& table = *object.table;
  const std::vector<int32_t>& corners = object.description.topology.triangles;
  const std::vector<glm::vec3>& rest =
      object.description.rest.empty() ? object.positions : object.description.rest;
  // Neighbours mostly lie on the same triangle and in the same cube.
  struct Last {
    int32_t triangle = -1;
    glm::dvec3 from{0.0}, first{0.0}, second{0.0};
    glm::dvec3 cube{std::numeric_limits<double>::infinity()};
    bool lets_go = false;
  };
  const auto lets_go = [&](size_t texel, Last& last) {
    if (table.triangle[texel] != last.triangle) {
      last.triangle = table.triangle[texel];
      const int32_t* const corner = &corners[3 * static_cast<size_t>(last.triangle)];
      const auto point = [&](int k) { return glm::dvec3(rest[static_cast<size_t>(corner[k])]); };
      last.from = point(0);
      last.first = point(1) - point(0);
      last.second = point(2) - point(0);
    }
    const glm::dvec2 weights(table.barycentric[texel]);
    const glm::dvec3 at = last.from + weights.x * last.first + weights.y * last.second;
    // The edge is a power of two.
    const glm::dvec3 cube = glm::floor(at * (1.0 / edge));
    if (cube != last.cube) {
      last.cube = cube;
      last.lets_go = hashed({static_cast<int64_t>(cube.x), static_cast<int64_t>(cube.y),
                             static_cast<int64_t>(cube.z)},
                            step_number, 0, kShedSalt) < share;
    }
    return last.lets_go;
  };
  constexpr size_t kTexels = 4096;
  std::vector<std::vector<int32_t>> let_go((table.texel.size() + kTexels - 1) / kTexels);
  base::for_each_item(let_go.size(), 1, [&](size_t run) {
    const size_t end = std::min((run + 1) * kTexels, table.texel.size());
    Last last;
    for (size_t i = run * kTexels; i < end; ++i) {
      if ((*map.height)[static_cast<size_t>(table.texel[i])] == 0.0f || !lets_go(i, last)) continue;
      let_go[run].push_back(static_cast<int32_t>(i));
    }
  });
  for (const std::vector<int32_t>& texels : let_go) {
    for (const int32_t texel : texels) {
      const auto i = static_cast<size_t>(texel);
      float& height = (*map.height)[static_cast<size_t>(table.texel[i])];
      const auto volume = static_cast<float>(static_cast<double>(std::abs(height)) *
                                             static_cast<double>(repose.bare().area[i]));
      map.slid += static_cast<double>(volume);
      map.shed_from.emplace_back(table.texel[i], volume);
      height = 0.0f;
      map.has_changed = true;
    }
  }
}

}  // namespace snowbough::snow
