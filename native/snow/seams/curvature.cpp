#include "snow/seams/curvature.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/parallel_for.h"

namespace snowbough::snow {
namespace {

constexpr LayerTerms kFlat{1.0f, 0.0f, 0.0f};
/// Normals at more than about 80 degrees from the face would make heights explode.
constexpr float kLeastCosine = 0.2f;
constexpr float kMostGrowth = 1.25f;
/// How near a layer comes to folding.
constexpr float kFold = 0.98f;
constexpr int kNewtonSteps = 5;

glm::vec3 unit(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 1e-30f ? v / length : glm::vec3(0.0f);
}

float angle_between(const glm::vec3& a, const glm::vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

struct Face {
  glm::vec3 p[3];
  /// Length: twice the area.
  glm::vec3 normal;
};

Face face_of(const std::vector<int32_t>& triangles, const std::vector<glm::vec3>& positions,
             size_t t) {
  Face face;
  for (size_t k = 0; k < 3; ++k) face.p[k] = positions[static_cast<size_t>(triangles[3 * t + k])];
  face.normal = glm::cross(face.p[1] - face.p[0], face.p[2] - face.p[0]);
  return face;
}

/// Sums, per number of `shading`, of normals weighted by their corners' angles.
std::vector<glm::vec3> shared_normals(const std::vector<int32_t>& triangles,
                                      const std::vector<int32_t>& shading, int32_t numbers,
                                      const std::vector<glm::vec3>& positions) {
  std::vector<glm::vec3> normals(static_cast<size_t>(numbers), glm::vec3(0.0f));
  for (size_t t = 0; t < shading.size() / 3; ++t) {
    const Face face = face_of(triangles, positions, t);
    const glm::vec3 normal = unit(face.normal);
    for (size_t k = 0; k < 3; ++k) {
      const int32_t number = shading[3 * t + k];
      if (number < 0) continue;
      normals[static_cast<size_t>(number)] +=
          normal * angle_between(face.p[(k + 1) % 3] - face.p[k], face.p[(k + 2) % 3] - face.p[k]);
    }
  }
  for (glm::vec3& normal : normals) normal = unit(normal);
  return normals;
}

/// At one point of a triangle, for unit normals N: the parts of ((P_u + t N_u) x (P_v + t N_v)) . N
/// by the powers of the height t, integrated over it.
LayerTerms terms_at(const glm::vec3& p_u, const glm::vec3& p_v, const glm::vec3 (&normal)[3],
                    glm::vec2 at) {
  const glm::vec3 mean = normal[0] * (1.0f - at.x - at.y) + normal[1] * at.x + normal[2] * at.y;
  const float length = glm::length(mean);
  if (!(length > 1e-6f)) return LayerTerms(0.0f);
  const glm::vec3 n = mean / length;
  const auto turned = [&](const glm::vec3& step) {
    return (step - n * glm::dot(n, step)) / length;
  };
  const glm::vec3 n_u = turned(normal[1] - normal[0]);
  const glm::vec3 n_v = turned(normal[2] - normal[0]);
  const glm::vec3 bend = glm::cross(p_u, n_v) + glm::cross(n_u, p_v);
  return {glm::dot(glm::cross(p_u, p_v), n), 0.5f * glm::dot(bend, n),
          glm::dot(glm::cross(n_u, n_v), n) / 3.0f};
}

/// Of the prism between a triangle and the same displaced: the mean of three points, exact where
/// the terms change evenly or with the square of the place.
LayerTerms prism_terms(const Face& face, const glm::vec3 (&normal)[3]) {
  const float area = glm::length(face.normal);
  if (!(area > 1e-30f)) return kFlat;
  const glm::vec3 p_u = face.p[1] - face.p[0];
  const glm::vec3 p_v = face.p[2] - face.p[0];
  LayerTerms sum(0.0f);
  for (const glm::vec2 at : {glm::vec2(1.0f, 1.0f), {4.0f, 1.0f}, {1.0f, 4.0f}}) {
    sum += terms_at(p_u, p_v, normal, at / 6.0f);
  }
  sum /= 3.0f * area;
  return {std::max(kLeastCosine, sum.x), sum.y, sum.z};
}

/// The height per held, 1 on flat ground: y of y + a y^2 + b y^3 = 1.
float growth(float a, float b) {
  const float root = a * a - 3.0f * b;
  const float turn = root >= 0.0f ? std::sqrt(root) - a : 0.0f;
  // Where the layer folds: 1 + 2 a y + 3 b y^2 = 0.
  const float fold = turn > 0.0f ? kFold / turn : std::numeric_limits<float>::max();
  const float most = std::min(fold, kMostGrowth);
  if (most * (1.0f + most * (a + most * b)) <= 1.0f) return most;
  const float without_b = 1.0f + 4.0f * a;
  float y = without_b > 0.0f ? std::min(2.0f / (1.0f + std::sqrt(without_b)), most) : most;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const float excess = y * (1.0f + y * (a + y * b)) - 1.0f;
    const float slope = 1.0f + y * (2.0f * a + y * 3.0f * b);
    y = std::clamp(y - excess / std::max(slope, 0.05f), 0.0f, most);
  }
  return y;
}

}  // namespace

std::vector<LayerTerms> layer_terms(const std::vector<int32_t>& triangles,
                                    const std::vector<int32_t>& shading,
                                    const std::vector<glm::vec3>& positions) {
  const int32_t numbers =
      shading.empty() ? 0 : *std::max_element(shading.begin(), shading.end()) + 1;
  if (numbers <= 0) return {};
  const std::vector<glm::vec3> shared = shared_normals(triangles, shading, numbers, positions);
  std::vector<LayerTerms> sum(shared.size(), LayerTerms(0.0f));
  std::vector<float> area(shared.size(), 0.0f);
  for (size_t t = 0; t < shading.size() / 3; ++t) {
    const Face face = face_of(triangles, positions, t);
    glm::vec3 normal[3];
    for (size_t k = 0; k < 3; ++k) {
      const int32_t number = shading[3 * t + k];
      normal[k] = number < 0 ? unit(face.normal) : shared[static_cast<size_t>(number)];
    }
    const LayerTerms terms = prism_terms(face, normal);
    const float weight = glm::length(face.normal);
    for (size_t k = 0; k < 3; ++k) {
      const int32_t number = shading[3 * t + k];
      if (number < 0) continue;
      sum[static_cast<size_t>(number)] += weight * terms;
      area[static_cast<size_t>(number)] += weight;
    }
  }
  std::vector<LayerTerms> corners(shading.size(), kFlat);
  for (size_t c = 0; c < shading.size(); ++c) {
    const int32_t number = shading[c];
    if (number >= 0 && area[static_cast<size_t>(number)] > 0.0f) {
      corners[c] = sum[static_cast<size_t>(number)] / area[static_cast<size_t>(number)];
    }
  }
  return corners;
}

float layer_height(float held, LayerTerms terms) {
  const float level = held / terms.x;
  return level * growth(terms.y * level / terms.x, terms.z * level * level / terms.x);
}

void show_layers(const TexelTable& table, const std::vector<LayerTerms>& terms,
                 std::vector<float>& map, int32_t threads) {
  if (terms.empty()) return;
  base::for_each_item(
      table.texel.size(), 8192,
      [&](size_t i) {
        float& height = map[static_cast<size_t>(table.texel[i])];
        if (height == 0.0f) return;
        const LayerTerms* corner = terms.data() + 3 * static_cast<size_t>(table.triangle[i]);
        const glm::vec2 w = table.barycentric[i];
        height = layer_height(height,
                              corner[0] * (1.0f - w.x - w.y) + corner[1] * w.x + corner[2] * w.y);
      },
      threads);
}

}  // namespace snowbough::snow
