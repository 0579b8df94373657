#include "render/snow/refine.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

namespace snowbough::render {
namespace {

using glm::vec2;
using glm::vec3;

class Refiner {
 public:
  Refiner(const SnowSource& source, float longest_uv) : source_(source), longest_uv_(longest_uv) {
    for (int32_t v = 0; v < static_cast<int32_t>(source.positions.size()); ++v) {
      made_.vertex_parents.push_back({v, v, v});
      made_.vertex_weights.emplace_back(1.0f, 0.0f, 0.0f);
    }
    made_.triangles = source.triangles;
    const vec3 a(1, 0, 0), b(0, 1, 0), c(0, 0, 1);
    made_.corner_weights.assign(source.triangles.size(), {a, b, c});
    for (size_t t = 0; t < source.triangles.size(); ++t) {
      made_.source_triangle.push_back(static_cast<int32_t>(t));
    }
  }

  RefinedMesh run() {
    while (find_long_edges()) split_all();
    return std::move(made_);
  }

 private:
  using Edge = std::pair<int32_t, int32_t>;

  static Edge edge(int32_t a, int32_t b) { return {std::min(a, b), std::max(a, b)}; }

  vec2 uv(size_t triangle, const vec3& weights) const {
    const auto& of = source_.uv[made_.source_triangle[triangle]];
    return weights.x * of[0] + weights.y * of[1] + weights.z * of[2];
  }

  bool find_long_edges() {
    middles_.clear();
    for (size_t t = 0; t < made_.triangles.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const vec3 from = made_.corner_weights[t][k], to = made_.corner_weights[t][(k + 1) % 3];
        if (glm::distance(uv(t, from), uv(t, to)) <= longest_uv_) continue;
        const Edge of = edge(made_.triangles[t][k], made_.triangles[t][(k + 1) % 3]);
        if (middles_.count(of) == 0) middles_[of] = add_vertex(t, 0.5f * (from + to));
      }
    }
    return !middles_.empty();
  }

  int32_t add_vertex(size_t triangle, const vec3& weights) {
    made_.vertex_parents.push_back(source_.triangles[made_.source_triangle[triangle]]);
    made_.vertex_weights.push_back(weights);
    return static_cast<int32_t>(made_.vertex_parents.size()) - 1;
  }

  int32_t middle(int32_t a, int32_t b) const {
    const auto found = middles_.find(edge(a, b));
    return found == middles_.end() ? -1 : found->second;
  }

  void split_all() {
    RefinedMesh before;
    std::swap(before.triangles, made_.triangles);
    std::swap(before.source_triangle, made_.source_triangle);
    std::swap(before.corner_weights, made_.corner_weights);
    for (size_t t = 0; t < before.triangles.size(); ++t) {
      split(before.triangles[t], before.corner_weights[t], before.source_triangle[t]);
    }
  }

  /// Cuts a triangle where its edges have middles, so that both faces of an edge have the same.
  void split(const std::array<int32_t, 3>& vertices, const std::array<vec3, 3>& weights,
             int32_t source) {
    std::array<int32_t, 6> v{};
    std::array<vec3, 6> w{};
    int cuts = 0;
    // Corner 0 is turned so that one cut lies on edge 0, and two on edges 0 and 1.
    const auto is_cut = [&](int k) { return middle(vertices[k % 3], vertices[(k + 1) % 3]) >= 0; };
    for (int k = 0; k < 3; ++k) cuts += is_cut(k) ? 1 : 0;
    int first = 0;
    while (cuts > 0 && cuts < 3 && !(is_cut(first) && !is_cut(first + 2))) ++first;
    for (int k = 0; k < 3; ++k) {
      const int here = (first + k) % 3, next = (first + k + 1) % 3;
      v[k] = vertices[here];
      w[k] = weights[here];
      v[3 + k] = middle(vertices[here], vertices[next]);
      w[3 + k] = 0.5f * (weights[here] + weights[next]);
    }
    static constexpr std::array<std::array<int, 3>, 1> kWhole{{{0, 1, 2}}};
    static constexpr std::array<std::array<int, 3>, 2> kOne{{{0, 3, 2}, {3, 1, 2}}};
    static constexpr std::array<std::array<int, 3>, 3> kTwo{{{3, 1, 4}, {0, 3, 4}, {0, 4, 2}}};
    static constexpr std::array<std::array<int, 3>, 4> kThree{
        {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
    const auto add = [&](const auto& parts) {
      for (const auto& part : parts) {
        made_.triangles.push_back({v[part[0]], v[part[1]], v[part[2]]});
        made_.corner_weights.push_back({w[part[0]], w[part[1]], w[part[2]]});
        made_.source_triangle.push_back(source);
      }
    };
    if (cuts == 0) add(kWhole);
    if (cuts == 1) add(kOne);
    if (cuts == 2) add(kTwo);
    if (cuts == 3) add(kThree);
  }

  const SnowSource& source_;
  float longest_uv_;
  RefinedMesh made_;
  std::map<Edge, int32_t> middles_;
};

}  // namespace

RefinedMesh refine(const SnowSource& source, int32_t resolution, float most_texels) {
  return Refiner(source, most_texels / static_cast<float>(resolution)).run();
}

}  // namespace snowbough::render
