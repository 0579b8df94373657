#include "tree/kept/upright.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace snowbough::tree {
namespace {

/// Joints of the limb, and layers of points whose middles they are.
constexpr int kLayers = 5;

}  // namespace

Branch upright_limb(const std::vector<glm::vec3>& points, const std::vector<char>& used, int up) {
  double low = std::numeric_limits<double>::max();
  double high = -low;
  for (size_t v = 0; v < points.size(); ++v) {
    if (used[v] == 0) continue;
    low = std::min(low, static_cast<double>(points[v][up]));
    high = std::max(high, static_cast<double>(points[v][up]));
  }
  struct Layer {
    glm::dvec3 sum{0.0};
    double count = 0.0;
    double away = 0.0;
  };
  std::array<Layer, kLayers> layers;
  const double spacing = std::max((high - low) / (kLayers - 1), 1e-12);
  const auto layer_of = [&](const glm::vec3& p) -> Layer& {
    const auto number = std::lround((static_cast<double>(p[up]) - low) / spacing);
    return layers[std::clamp<long>(number, 0, kLayers - 1)];
  };
  for (size_t v = 0; v < points.size(); ++v) {
    if (used[v] == 0) continue;
    layer_of(points[v]).sum += glm::dvec3(points[v]);
    layer_of(points[v]).count += 1.0;
  }
  Branch limb;
  limb.level = -1;
  for (int i = 0; i < kLayers; ++i) {
    glm::dvec3 middle = layers[i].count > 0.0 ? layers[i].sum / layers[i].count
                        : i > 0               ? glm::dvec3(limb.points.back())
                                              : glm::dvec3(0.0);
    middle[up] = low + i * spacing;
    limb.points.emplace_back(middle);
  }
  for (size_t v = 0; v < points.size(); ++v) {
    if (used[v] == 0) continue;
    Layer& layer = layer_of(points[v]);
    glm::dvec3 away = glm::dvec3(points[v]) - glm::dvec3(limb.points[&layer - layers.data()]);
    away[up] = 0.0;
    layer.away += glm::length(away);
  }
  float radius = 0.0f;
  for (const Layer& layer : layers) {
    if (layer.count > 0.0) radius = static_cast<float>(layer.away / layer.count);
    limb.radii.push_back(radius);
    limb.areas.push_back(static_cast<float>(M_PI) * radius * radius);
  }
  limb.attach_point = limb.points.front();
  return limb;
}

}  // namespace snowbough::tree
