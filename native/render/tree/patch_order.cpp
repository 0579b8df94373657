#include "render/tree/patch_order.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "shaders/lib/thin_limbs.h"

namespace snowbough::render {
namespace {

constexpr float kTurn = 6.2831853f;
/// Patches with the number 1 are dropped without fading.
constexpr float kLastNumber = 0.9999f;

DropSize size_of(const TreePatches& tree, const shared::TreePatch& patch) {
  DropSize size;
  for (int k = 0; k < 4; ++k) {
    const shared::TreeVertex& vertex = tree.vertices[static_cast<size_t>(patch.vertices[k])];
    const float radius = vertex.normal.w / kTurn;
    size.reach = std::max(size.reach, (1.0f + shared::kSquareGrowth) * radius + vertex.position.w);
  }
  const bool is_cap = patch.limb.x < 0;
  size.length = is_cap ? 0.0f : tree.sections[static_cast<size_t>(patch.limb.x)].begin.w;
  size.number = is_cap ? 1.0f : 0.0f;
  return size;
}

/// Index of the first number of the van der Corput sequence (0, 1/2, 1/4, 3/4, 1/8, 5/8, ...) from
/// `begin` to before `end`, both from 0 to 1: its bits are those of the number, reversed.
uint64_t first_within(double begin, double end) {
  uint64_t index = 0;
  for (int bits = 0; bits < 52; ++bits) {
    const double step = std::ldexp(1.0, -bits);
    const auto multiple = static_cast<uint64_t>(std::ceil(begin / step));
    if (static_cast<double>(multiple) * step >= end) continue;
    for (int b = 0; b < bits; ++b) index |= (multiple >> b & 1) << (bits - 1 - b);
    return index;
  }
  return ~uint64_t{0};
}

/// Numbers of patches with which the patches drawn from far away cover what all do, whatever their
/// sizes: systematic sampling with chances in proportion to the areas. The areas lie side by side
/// from 0 to 1 in the order of the limbs, and the patches are ordered by the first number of the
/// van der Corput sequence in their part: the first ones of any count are spread evenly over all
/// limbs, so that even a dozen lie and face as all do. The k-th gets the number at which k areas'
/// worth of patches are drawn.
void number_patches(std::vector<DropSize>& sizes) {
  const auto area = [&](size_t f) { return sizes[f].reach * sizes[f].length; };
  std::vector<size_t> by_area, order;
  for (size_t f = 0; f < sizes.size(); ++f) {
    if (sizes[f].number >= 1.0f || !(area(f) > 0.0f)) continue;
    by_area.push_back(f);
  }
  order = by_area;
  std::stable_sort(by_area.begin(), by_area.end(),
                   [&](size_t f, size_t g) { return area(f) > area(g); });
  double smaller = 0.0;
  for (const size_t f : by_area) smaller += area(f);
  std::vector<uint64_t> turns(sizes.size());
  double before = 0.0;
  for (const size_t f : order) {
    turns[f] = first_within(before / smaller, (before + area(f)) / smaller);
    before += area(f);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t f, size_t g) { return turns[f] < turns[g]; });
  // Of the largest patches all are drawn.
  size_t all = 0;
  for (size_t k = 0; k < order.size(); ++k) {
    const auto scale = [&] { return (static_cast<double>(k - all) + 0.5) / smaller; };
    while (all < k && scale() * area(by_area[all]) > 1.0) smaller -= area(by_area[all++]);
    const double number = scale() * area(order[k]);
    sizes[order[k]].number = std::min(static_cast<float>(number), kLastNumber);
  }
}

/// Numbers things by their first use.
class FirstUse {
 public:
  explicit FirstUse(size_t count) : number_(count, -1) {}
  int32_t number_of(int32_t old) {
    int32_t& number = number_[static_cast<size_t>(old)];
    if (number < 0) {
      number = static_cast<int32_t>(order_.size());
      order_.push_back(old);
    }
    return number;
  }
  int32_t used() const { return static_cast<int32_t>(order_.size()); }
  /// Unused things come last.
  template <typename Thing>
  std::vector<Thing> ordered(const std::vector<Thing>& things) {
    for (size_t i = 0; i < things.size(); ++i) number_of(static_cast<int32_t>(i));
    std::vector<Thing> made;
    made.reserve(things.size());
    for (const int32_t old : order_) made.push_back(things[static_cast<size_t>(old)]);
    return made;
  }

 private:
  std::vector<int32_t> number_;
  std::vector<int32_t> order_;
};

}  // namespace

void order_patches(TreePatches& tree) {
  const size_t count = tree.patches.size();
  std::vector<DropSize> sizes;
  std::vector<float> points;
  for (size_t f = 0; f < count; ++f) {
    sizes.push_back(size_of(tree, tree.patches[f]));
  }
  number_patches(sizes);
  for (size_t f = 0; f < count; ++f) {
    tree.patches[f].rest[2].w = sizes[f].number;
    points.push_back(drop_point(sizes[f], 0.0f));
  }
  tree.quads.resize(count);
  std::iota(tree.quads.begin(), tree.quads.end(), 0);
  std::stable_sort(tree.quads.begin(), tree.quads.end(), [&](int32_t a, int32_t b) {
    return points[static_cast<size_t>(a)] < points[static_cast<size_t>(b)];
  });

  FirstUse vertices(tree.vertices.size()), edges(tree.edges.size());
  std::vector<shared::TreePatch> patches;
  std::vector<DropSize> ordered;
  for (const int32_t quad : tree.quads) {
    shared::TreePatch patch = tree.patches[static_cast<size_t>(quad)];
    for (int k = 0; k < 4; ++k) {
      patch.vertices[k] = vertices.number_of(patch.vertices[k]);
      patch.edges[k] = 2 * edges.number_of(patch.edges[k] >> 1) + (patch.edges[k] & 1);
    }
    patches.push_back(patch);
    ordered.push_back(sizes[static_cast<size_t>(quad)]);
    tree.used_vertices.push_back(vertices.used());
    tree.used_edges.push_back(edges.used());
  }
  tree.patches = std::move(patches);
  tree.vertices = vertices.ordered(tree.vertices);
  tree.edges = edges.ordered(tree.edges);
  for (shared::TreeEdge& edge : tree.edges) {
    edge.ends.x = vertices.number_of(edge.ends.x);
    edge.ends.y = vertices.number_of(edge.ends.y);
  }
  tree.order = DropOrder(std::move(ordered));
}

}  // namespace snowbough::render
