// Time of a frame of snow on a waving field of 2 x 128 x 128 triangles, 10 m wide, by map
// resolution; and time of building the texel table of such a field.
#include <benchmark/benchmark.h>

#include <cmath>
#include <exception>
#include <vector>

#include "snow/simulation.h"
#include "snow/texels/texel_table.h"

namespace {

using namespace snowbough::snow;

constexpr int kCells = 128;
constexpr float kExtent = 10.0f;

std::vector<glm::vec3> field_positions() {
  std::vector<glm::vec3> positions;
  for (int row = 0; row <= kCells; ++row) {
    for (int column = 0; column <= kCells; ++column) {
      const float x = kExtent * static_cast<float>(column) / kCells;
      const float y = kExtent * static_cast<float>(row) / kCells;
      positions.emplace_back(x, y, 0.3f * std::sin(2.0f * x) * std::cos(1.5f * y));
    }
  }
  return positions;
}

MapTopology field_topology(int resolution) {
  MapTopology field;
  field.resolution = resolution;
  field.vertex_count = (kCells + 1) * (kCells + 1);
  const auto add_corner = [&field](int row, int column) {
    field.triangles.push_back(row * (kCells + 1) + column);
    field.corner_uv.emplace_back(static_cast<float>(column) / kCells,
                                 static_cast<float>(row) / kCells);
  };
  for (int row = 0; row < kCells; ++row) {
    for (int column = 0; column < kCells; ++column) {
      add_corner(row, column);
      add_corner(row, column + 1);
      add_corner(row + 1, column + 1);
      add_corner(row, column);
      add_corner(row + 1, column + 1);
      add_corner(row + 1, column);
    }
  }
  return field;
}

void texel_table(benchmark::State& state) {
  const MapTopology field = field_topology(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    TexelTable table = build_texel_table(field);
    benchmark::DoNotOptimize(table);
  }
}

void snow_step(benchmark::State& state) try {
  const int resolution = static_cast<int>(state.range(0));
  SimulationSettings settings;
  settings.pixel_size = kExtent / resolution;
  SnowSimulation simulation(settings);
  ObjectDescription field;
  field.name = "field";
  field.topology = field_topology(resolution);
  simulation.add_object(field);
  const std::vector<glm::vec3> positions = field_positions();
  for (auto _ : state) {
    simulation.step({{"field", positions}}, 0.001, {0.3, 0.0, -1.0}, 1.0 / 24.0);
    benchmark::DoNotOptimize(simulation.statistics());
  }
  state.SetLabel(simulation.engine_info().driver);
} catch (const std::exception& error) {
  // No EGL, or a map that is too large for the driver: the table says so.
  state.SkipWithError(error.what());
}

BENCHMARK(texel_table)->Arg(512)->Arg(1024)->Arg(2048)->Unit(benchmark::kMillisecond);
BENCHMARK(snow_step)->Arg(512)->Arg(1024)->Arg(2048)->Unit(benchmark::kMillisecond);

}  // namespace
