#include "snow/surface/vertex_turns.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

namespace snowbough::snow {
namespace {

struct VertexFrame {
  glm::vec3 normal_before{0.0f};
  glm::vec3 normal{0.0f};
  int32_t neighbour = -1;
};

glm::mat3 basis(const glm::vec3& normal, const glm::vec3& direction) {
  const glm::vec3 n = glm::normalize(normal);
  const glm::vec3 x = glm::normalize(direction - n * glm::dot(n, direction));
  return {x, glm::cross(n, x), n};
}

}  // namespace

std::vector<glm::quat> vertex_turns(const std::vector<int32_t>& triangles,
                                    const std::vector<glm::vec3>& before, const glm::vec3* now) {
  std::vector<VertexFrame> frames(before.size());
  for (size_t c = 0; c < triangles.size(); c += 3) {
    const int32_t a = triangles[c];
    const int32_t b = triangles[c + 1];
    const int32_t d = triangles[c + 2];
    const glm::vec3 cross_before = glm::cross(before[b] - before[a], before[d] - before[a]);
    const glm::vec3 cross = glm::cross(now[b] - now[a], now[d] - now[a]);
    for (size_t k = 0; k < 3; ++k) {
      VertexFrame& frame = frames[triangles[c + k]];
      frame.normal_before += cross_before;
      frame.normal += cross;
      if (frame.neighbour < 0) frame.neighbour = triangles[c + (k + 1) % 3];
    }
  }
  std::vector<glm::quat> turns(before.size(), glm::quat(1.0f, 0.0f, 0.0f, 0.0f));
  for (size_t v = 0; v < before.size(); ++v) {
    const VertexFrame& frame = frames[v];
    if (frame.neighbour < 0) continue;
    const glm::mat3 old = basis(frame.normal_before, before[frame.neighbour] - before[v]);
    const glm::mat3 turned = basis(frame.normal, now[frame.neighbour] - now[v]);
    const glm::quat turn = glm::quat_cast(turned * glm::transpose(old));
    if (std::isfinite(turn.x + turn.y + turn.z + turn.w)) turns[v] = turn;
  }
  return turns;
}

}  // namespace snowbough::snow
