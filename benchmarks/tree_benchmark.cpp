// Time of the import's native part on a grown maple of 324 branches, and of its UV maps alone.
#include <benchmark/benchmark.h>

#include "tree/build_tree_mesh.h"
#include "tree/leaves/leaf_uvs.h"
#include "tree/read_tree.h"
#include "tree/uv/chart_layout.h"
#include "tree/uv/snow_uvs.h"
#include "tree/uv/strip_rows.h"

namespace {

using namespace snowbough::tree;

void read_maple(benchmark::State& state) {
  for (auto _ : state) {
    Skeleton skeleton = read_tree(SNOWBOUGH_BENCHMARK_TREE);
    benchmark::DoNotOptimize(skeleton);
    state.counters["branches"] = static_cast<double>(skeleton.branches.size());
  }
}

void build_maple(benchmark::State& state) {
  ReadTreeOptions options;
  options.simplify = Simplify::kTolerance;
  const Skeleton skeleton = read_tree(SNOWBOUGH_BENCHMARK_TREE, options);
  for (auto _ : state) {
    TreeMesh mesh = build_tree_mesh(skeleton);
    benchmark::DoNotOptimize(mesh);
    state.counters["quads"] = static_cast<double>(mesh.quads.size());
    state.counters["bones"] = static_cast<double>(mesh.bones.heads.size());
  }
}

/// Charts of the limbs, by one thread, on a map of state.range(0) squared texels.
void layout_maple_charts(benchmark::State& state) {
  const Skeleton skeleton = read_tree(SNOWBOUGH_BENCHMARK_TREE);
  const TreeMesh mesh = build_tree_mesh(skeleton);
  const auto resolution = static_cast<int>(state.range(0));
  int attempts = 0;
  const snowbough::base::Execution execution{1, [&attempts](float) { return ++attempts > 0; }};
  for (auto _ : state) {
    attempts = 0;
    const auto layout = lay_out_charts(collect_strips(mesh, skeleton), resolution, execution);
    state.counters["charts"] = static_cast<double>(layout->shapes.charts.size());
    state.counters["attempts"] = attempts;
    state.counters["columns"] =
        static_cast<double>(layout->packing.used_columns) * layout->map.cell_size / resolution;
  }
}

/// The `snow` UV map of the limbs, by one thread.
void layout_maple_snow_uvs(benchmark::State& state) {
  const Skeleton skeleton = read_tree(SNOWBOUGH_BENCHMARK_TREE);
  TreeMesh mesh = build_tree_mesh(skeleton);
  for (auto _ : state) {
    layout_snow_uvs(mesh, skeleton, static_cast<int>(state.range(0)), {1, {}});
    benchmark::DoNotOptimize(mesh.uv_snow.data());
  }
}

/// Leaves of two quads, bent along the middle.
Foliage bent_leaves(int32_t count) {
  Foliage foliage;
  foliage.face_begin.push_back(0);
  for (int32_t leaf = 0; leaf < count; ++leaf) {
    const auto first = static_cast<int32_t>(foliage.vertices.size());
    const float size = 0.05f + 0.01f * static_cast<float>(leaf % 7);
    const auto x = static_cast<float>(leaf);
    for (const float y : {0.0f, size, 2.0f * size}) {
      foliage.vertices.emplace_back(x, y, 0.0f);
      foliage.vertices.emplace_back(x + size, y, 0.3f * y);
    }
    for (const int32_t low : {first, first + 2}) {
      for (const int32_t corner : {low, low + 1, low + 3, low + 2}) {
        foliage.corner_vertex.push_back(corner);
      }
      foliage.face_begin.push_back(static_cast<int32_t>(foliage.corner_vertex.size()));
      foliage.face_leaf.push_back(leaf);
    }
  }
  return foliage;
}

/// The `snow` UV map of 20,000 leaves, by one thread.
void layout_leaves(benchmark::State& state) {
  const Foliage foliage = bent_leaves(20000);
  for (auto _ : state) {
    LeafUvs layout = layout_leaf_uvs(foliage, 1024, {1, {}});
    benchmark::DoNotOptimize(layout.corner_uv.data());
  }
}

BENCHMARK(read_maple)->Unit(benchmark::kMillisecond);
BENCHMARK(build_maple)->Unit(benchmark::kMillisecond);
BENCHMARK(layout_maple_charts)->Arg(1024)->Arg(2048)->Unit(benchmark::kMillisecond);
BENCHMARK(layout_maple_snow_uvs)->Arg(1024)->Arg(2048)->Unit(benchmark::kMillisecond);
BENCHMARK(layout_leaves)->Unit(benchmark::kMillisecond);

}  // namespace
