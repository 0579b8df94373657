#pragma once

#include <cmath>
#include <vector>

#include "gpu/gpu_thread.h"
#include "render/frame_drawing.h"
#include "render/tree/tree_patches.h"

namespace snowbough::render {

/// A limb of four sides around the z axis, a metre high and 0.2 m thick, with a bone, both ends
/// open. `with_places`: each side has a quarter of the map for its snow.
inline TreeSource tube(bool with_places) {
  TreeSource source;
  for (int row = 0; row < 2; ++row) {
    for (int k = 0; k < 4; ++k) {
      const float turn = 1.5707963f * static_cast<float>(k);
      source.vertices.emplace_back(0.1f * std::cos(turn), 0.1f * std::sin(turn),
                                   static_cast<float>(row));
    }
  }
  source.bone_indices.assign(8, {0, 0, 0, 0});
  source.bone_weights.assign(8, {1.0f, 0.0f, 0.0f, 0.0f});
  source.bone_count = 1;
  for (int32_t k = 0; k < 4; ++k) {
    const int32_t next = (k + 1) % 4;
    const float low = 0.25f * static_cast<float>(k), high = low + 0.25f;
    source.quads.push_back({k, next, next + 4, k + 4});
    source.bark_uv.push_back(
        {glm::vec2(low, 0), glm::vec2(high, 0), glm::vec2(high, 1.6f), glm::vec2(low, 1.6f)});
    if (with_places) {
      source.snow_uv.push_back(
          {glm::vec2(low, 0), glm::vec2(high, 0), glm::vec2(high, 1), glm::vec2(low, 1)});
    }
  }
  source.branch_level.assign(4, 0);
  source.branch.assign(4, 0);
  source.section.assign(4, 0);
  source.kind.assign(4, QuadKind::kWall);
  source.sections = {{glm::vec3(0.0f), glm::vec3(0, 0, 1), 1.0f, 0.1f, 0.1f, false}};
  return source;
}

/// A level square of a metre around the origin; `is_snow`: of snow.
inline MeshSource square(bool is_snow) {
  MeshSource source;
  source.vertices = {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}};
  source.triangles = {{0, 1, 2}, {0, 2, 3}};
  source.materials[0].color = glm::vec3(0.8f, 0.0f, 0.0f);
  source.is_snow = is_snow;
  return source;
}

/// Snow of one depth on all of a tree.
inline TreeSnow blanket(float depth) {
  return {4, 4, std::vector<float>(16, depth), {depth, depth > 0.0f ? depth : 1.0f}};
}

/// A square picture from 4 m in front of the origin, a little from above.
inline Camera square_camera(int32_t size = 64) {
  Camera camera;
  camera.eye = glm::vec3(0.0f, -4.0f, 2.0f);
  camera.target = glm::vec3(0.0f, 0.0f, 0.3f);
  camera.width = camera.height = size;
  return camera;
}

struct Scene {
  SceneObjects objects;
  FrameDrawing frames{objects};
};

/// Does `work` with a scene on the GPU thread.
template <typename Work>
void with_scene(const Work& work) {
  gpu::GpuThread::shared("")->run([&] {
    Scene scene;
    work(scene);
  });
}

/// Pixels in which something was drawn.
inline int32_t covered(const Picture& picture) {
  int32_t count = 0;
  for (size_t i = 3; i < picture.rgba.size(); i += 4) count += picture.rgba[i] == 255 ? 1 : 0;
  return count;
}

}  // namespace snowbough::render
