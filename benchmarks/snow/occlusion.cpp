// Time of the occlusion: triangle set-up and rasterisation on the processor against the passes in
// OpenGL, by width of the tile and number of triangles. Prints a markdown table.
//
//   snowbough_occlusion_benchmark [milliseconds a row] [processor]
//
// A wavy field of two triangles a cell fills the tile; above it hang random triangles of the same
// size, one tenth as many. "large": 1,000 random triangles half a tile wide. "holes": a mask of 64
// x 64 texels cuts every other texel out of each triangle. Times are the medians of repeated runs,
// each with all pixels where the deposit reads them: in a buffer, or in memory. "processor": the
// sum over all threads of the process instead of wall-clock time, for busy machines and for OpenGL
// that runs on the processor.
#include "snow/step/gl/occlusion.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <glm/vec3.hpp>
#include <random>
#include <string>
#include <vector>

#include "gpu/gpu_thread.h"
#include "snow/step/cpu/occlusion/occlusion.h"
#include "snow/step/cpu/passes.h"
#include "snow/step/gl/passes.h"

namespace snowbough::snow {
namespace {

/// Vertices in units of the tile's width, around the origin.
struct Scene {
  std::vector<glm::vec3> positions;
  std::vector<shared::SceneTriangle> triangles;
  /// Empty, or one per triangle, all with the same mask.
  std::vector<shared::AlphaTriangle> alpha;
  std::vector<shared::AlphaMaskHeader> masks;
  std::vector<uint32_t> mask_bits;

  TriangleRange range() const {
    return {0, static_cast<int32_t>(triangles.size()), !alpha.empty(), 0};
  }

  void add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto first = static_cast<uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c});
    triangles.push_back({first, first + 1, first + 2, 0});
  }
};

void add_random(Scene& scene, int32_t count, float size) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-0.5f, 0.5f);
  for (int32_t i = 0; i < count; ++i) {
    const glm::vec3 middle(place(random), place(random), 0.2f + 0.1f * place(random));
    const auto corner = [&] {
      return middle + size * glm::vec3(place(random), place(random), place(random));
    };
    const glm::vec3 a = corner();
    const glm::vec3 b = corner();
    scene.add(a, b, corner());
  }
}

Scene field(int32_t triangle_count) {
  Scene scene;
  const auto cells = static_cast<int32_t>(std::sqrt(static_cast<double>(triangle_count) / 2.2));
  for (int32_t y = 0; y <= cells; ++y) {
    for (int32_t x = 0; x <= cells; ++x) {
      const glm::vec2 at(glm::vec2(x, y) / static_cast<float>(cells) - 0.5f);
      scene.positions.emplace_back(at, 0.02f * std::sin(20.0f * at.x) * std::cos(15.0f * at.y));
    }
  }
  for (int32_t y = 0; y < cells; ++y) {
    for (int32_t x = 0; x < cells; ++x) {
      const auto a = static_cast<uint32_t>(y * (cells + 1) + x);
      const uint32_t up = a + static_cast<uint32_t>(cells) + 1;
      scene.triangles.push_back({a, a + 1, up + 1, 0});
      scene.triangles.push_back({a, up + 1, up, 0});
    }
  }
  add_random(scene, triangle_count / 11, 2.0f / static_cast<float>(cells));
  return scene;
}

Scene with_holes(Scene scene) {
  scene.alpha.assign(scene.triangles.size(), {{0, 0}, {1, 0}, {0, 1}, 1, 0});
  scene.masks = {{0, 64, 64, shared::kAlphaRepeat}};
  scene.mask_bits.assign(64 * 64 / 32, 0x55555555u);
  return scene;
}

Scene large_triangles() {
  Scene scene;
  add_random(scene, 1000, 1.0f);
  return scene;
}

/// Time limit of a row, and the clock.
struct Budget {
  double milliseconds;
  bool is_processors;
};

double clock_milliseconds(const Budget& budget) {
  if (budget.is_processors) return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double, std::milli>(now).count();
}

/// Median of repeated runs in milliseconds, after one that warms up.
template <typename Work>
double median_time(const Budget& budget, const Work& work) {
  work();
  std::vector<double> times;
  double total = 0.0;
  while (times.size() < 3 || (total < budget.milliseconds && times.size() < 100)) {
    const double begin = clock_milliseconds(budget);
    work();
    times.push_back(clock_milliseconds(budget) - begin);
    total += times.back();
  }
  std::nth_element(times.begin(), times.begin() + static_cast<ptrdiff_t>(times.size() / 2),
                   times.end());
  return times[times.size() / 2];
}

struct Times {
  double setup;
  double occlusion;
};

struct Projection {
  shared::ProjectionFrame frame;
  Tile tile;
};

/// The scene fills a tile of `width` pixels, except a margin.
Projection project_on(int32_t width) {
  FallSettings settings;
  settings.pixel_size = 1.0 / width;
  settings.depth = 0.01;
  Bounds bounds;
  bounds.include({-0.5, -0.5, -1.0});
  bounds.include({0.5, 0.5, 1.0});
  Projection projection;
  projection.frame = make_projection_frame(settings, bounds);
  projection.tile = make_tiles({pixels_of(bounds, projection.frame)}, width).front();
  return projection;
}

Times on_gpu(const Scene& scene, const Projection& projection, const Budget& budget) {
  return gpu::GpuThread::shared()->run([&] {
    SceneBuffers buffers;
    buffers.triangle_count = static_cast<int32_t>(scene.triangles.size());
    buffers.positions = gpu::Buffer(scene.positions);
    buffers.triangles = gpu::Buffer(scene.triangles);
    buffers.triangle_corners = gpu::Buffer(int64_t{48} * buffers.triangle_count);
    buffers.triangle_surface = gpu::Buffer(int64_t{16} * buffers.triangle_count);
    buffers.views.positions = gpu::BufferTexture(buffers.positions, GL_RGB32F);
    buffers.views.triangles = gpu::BufferTexture(buffers.triangles, GL_RGBA32UI);
    buffers.views.triangle_corners = gpu::BufferTexture(buffers.triangle_corners, GL_RGBA32F);
    buffers.alpha_triangles = gpu::Buffer(scene.alpha);
    buffers.alpha_headers = gpu::Buffer(scene.masks);
    buffers.alpha_bits = gpu::Buffer(scene.mask_bits);
    buffers.views.alpha_triangles = gpu::BufferTexture(buffers.alpha_triangles, GL_RGBA32UI);
    buffers.views.alpha_headers = gpu::BufferTexture(buffers.alpha_headers, GL_RGBA32UI);
    buffers.views.alpha_bits = gpu::BufferTexture(buffers.alpha_bits, GL_R32UI);
    const gpu::Buffer frame(sizeof projection.frame, &projection.frame);
    TriangleSetupPass setup;
    OcclusionPass occlusion;
    OcclusionTarget target;
    Times times;
    times.setup = median_time(budget, [&] {
      setup.run(buffers, frame);
      glFinish();
    });
    times.occlusion = median_time(budget, [&] {
      occlusion.run(buffers, frame, projection.tile, {scene.range()}, target);
      glFinish();
    });
    return times;
  });
}

Times on_processor(const Scene& scene, const Projection& projection, const Budget& budget) {
  std::vector<glm::vec4> corners(3 * scene.triangles.size());
  std::vector<glm::vec4> surface(scene.triangles.size());
  const glm::ivec2 size = projection.tile.pixels.size();
  std::vector<shared::SeenPixel> seen(static_cast<size_t>(size.x) * static_cast<size_t>(size.y));
  const TriangleRange all = scene.range();
  cpu::OcclusionPass occlusion;
  Times times;
  times.setup = median_time(budget, [&] {
    cpu::set_up_triangles(scene.positions, scene.triangles, projection.frame, corners, surface);
  });
  times.occlusion = median_time(budget, [&] {
    occlusion.run({corners, {&all, 1}, {scene.alpha, scene.masks, scene.mask_bits}},
                  projection.tile.pixels, seen);
  });
  return times;
}

void print_row(const std::string& triangles, const Scene& scene, int32_t width,
               const Budget& budget) {
  const Projection projection = project_on(width);
  const Times gpu = on_gpu(scene, projection, budget);
  const Times cpu = on_processor(scene, projection, budget);
  std::printf("| %d | %s | %.2f | %.2f | %.1f | %.2f | %.2f | %.1f |\n", width, triangles.c_str(),
              gpu.setup, cpu.setup, gpu.setup / cpu.setup, gpu.occlusion, cpu.occlusion,
              gpu.occlusion / cpu.occlusion);
  std::fflush(stdout);
}

void print_table(const Budget& budget) {
  std::printf("OpenGL: %s; processor: %d threads; %s time\n\n",
              gpu::GpuThread::shared()->info().renderer.c_str(), base::default_threads(),
              budget.is_processors ? "processor" : "wall-clock");
  std::printf(
      "| tile | triangles | set-up, GL (ms) | processor (ms) | times faster | occlusion, GL (ms) "
      "| processor (ms) | times faster |\n|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  for (const int32_t width : {256, 1024, 4096}) {
    for (const auto& [name, count] : {std::pair("1k", 1000), std::pair("10k", 10000),
                                      std::pair("100k", 100000), std::pair("1M", 1000000)}) {
      print_row(name, field(count), width, budget);
    }
    print_row("100k, holes", with_holes(field(100000)), width, budget);
    print_row("1k, large", large_triangles(), width, budget);
  }
}

}  // namespace
}  // namespace snowbough::snow

int main(int argc, char** argv) try {
  snowbough::snow::print_table(
      {argc > 1 ? std::atof(argv[1]) : 1000.0, argc > 2 && std::string(argv[2]) == "processor"});
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
