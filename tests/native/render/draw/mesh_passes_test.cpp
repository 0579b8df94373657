#include "render/draw/mesh_passes.h"

#include <gtest/gtest.h>

#include <glm/ext/matrix_transform.hpp>
#include <stdexcept>

#include "gpu/gpu_thread.h"

namespace snowbough::render {
namespace {

using glm::mat4;
using glm::vec3;

MeshSource triangle() {
  MeshSource source;
  source.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  source.triangles = {{0, 1, 2}};
  return source;
}

template <typename Work>
void on_gpu(const Work& work) {
  gpu::GpuThread::shared("")->run(work);
}

TEST(MeshPasses, aMeshReachesOverAllOfItsPlaces) {
  on_gpu([] {
    MeshBuffers mesh(triangle());
    EXPECT_EQ(mesh.bounds().high, vec3(1, 2, 0));
    mesh.set_instances({mat4(1.0f), glm::translate(mat4(1.0f), vec3(0, 0, 5))});
    EXPECT_EQ(mesh.bounds().low, vec3(0, 0, 0));
    EXPECT_EQ(mesh.bounds().high, vec3(1, 2, 5));
  });
}

TEST(MeshPasses, whatDoesNotFitTheMeshIsRefused) {
  on_gpu([] {
    MeshSource lost = triangle();
    lost.triangles = {{0, 1, 3}};
    EXPECT_THROW(MeshBuffers{lost}, std::invalid_argument);
    MeshSource unpainted = triangle();
    unpainted.material = {1};
    EXPECT_THROW(MeshBuffers{unpainted}, std::invalid_argument);
    MeshBuffers mesh(triangle());
    EXPECT_THROW(mesh.set_snow({{}, 1, 1, {0.1f}}), std::invalid_argument);
    EXPECT_THROW(mesh.set_snow({std::vector<glm::vec2>(3), 2, 1, {0.1f}}), std::invalid_argument);
    EXPECT_NO_THROW(mesh.set_snow({std::vector<glm::vec2>(3), 1, 1, {0.1f}}));
  });
}

}  // namespace
}  // namespace snowbough::render
