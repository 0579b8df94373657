// How long the import's native part takes on a grown maple of 324 branches.
#include <benchmark/benchmark.h>

#include "tree/build_tree_mesh.h"
#include "tree/read_tree.h"

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

BENCHMARK(read_maple)->Unit(benchmark::kMillisecond);
BENCHMARK(build_maple)->Unit(benchmark::kMillisecond);

}  // namespace
