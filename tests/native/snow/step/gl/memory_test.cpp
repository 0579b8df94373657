
#include <gtest/gtest.h>

#include "native/render/gl_calls.h"
#include "native/snow/bench.h"
#include "native/snow/layouts.h"
#include "snow/step/frame_step.h"
#include "snow/step/gl/engine.h"

namespace snowbough::snow {
namespace {

int64_t allocated = 0;

struct CountsBuffer {
  static void of(GLuint /*buffer*/, GLsizeiptr bytes, const void* /*data*/, GLbitfield /*flags*/) {
    allocated += bytes;
  }
};

int64_t texel_bytes(GLenum format) {
  return format == GL_RG32UI ? 8 : 4;
}

struct CountsTexture {
  static void of(GLuint /*texture*/, GLsizei /*levels*/, GLenum format, GLsizei width,
                 GLsizei height, GLsizei layers = 1) {
    allocated += texel_bytes(format) * width * height * layers;
  }
};

SceneObject smooth_cylinder() {
  const LaidOutMesh mesh = cylinder(24, 8, 0.5f, 2.0f, 256);
  SceneObject object;
  object.description.name = "cylinder";
  object.description.topology = mesh.topology;
  object.description.shading = mesh.topology.triangles;
  object.table = std::make_shared<const TexelTable>(build_texel_table(mesh.topology));
  object.positions = mesh.positions;
  for (const glm::vec3& point : mesh.positions) object.bounds.include(glm::dvec3(point));
  return object;
}

/// Bytes that the driver allocates for two steps, and those of the estimate.
void compare(bool scatters) {
  SceneObject cylinder = smooth_cylinder();
  SceneObject ground = square("ground", 4.0f, 0.0f, 512);
  SceneObject roof = square("roof", 1.0f, 3.0f, 64, false);
  const std::vector<SceneObject*> objects{&cylinder, &ground, &roof};
  FrameStep step;
  step.fall = falling({0.0, 0.0, -1.0}, 4.0 / 500.0);
  step.dt = 0.1;
  step.tile_size = 512;
  const auto engine = gl::make_engine(gpu::GpuThread::shared(), scatters);
  Movement movement;
  movement.lay_out({&cylinder, &ground, &roof});
  engine->run([&] {
    allocated = 0;
    const render::Watched<&epoxy_glNamedBufferStorage, CountsBuffer> buffers;
    const render::Watched<&epoxy_glTextureStorage2D, CountsTexture> textures;
    const render::Watched<&epoxy_glTextureStorage3D, CountsTexture> arrays;
    engine->build_scene({&cylinder, &ground, &roof});
    for (int i = 0; i < 2; ++i) run_step(*engine, movement, objects, step);
  });
  MemoryEstimate estimate = engine->memory({&cylinder, &ground, &roof}, step.tile_size);
  const int64_t on_the_gpu = estimate.total() - estimate.output - estimate.seams;
  EXPECT_GE(on_the_gpu, allocated) << estimate.text();
  EXPECT_LE(static_cast<double>(on_the_gpu), 1.2 * static_cast<double>(allocated))
      << estimate.text();
}

TEST(GlMemory, EstimatesWhatAStepAllocates) {
  compare(false);
}

TEST(GlMemory, EstimatesWhatTheMappingGeometryAllocates) {
  compare(true);
}

}  // namespace
}  // namespace snowbough::snow
