#include "snow/scene/scene_layout.h"

#include <map>
#include <memory>

#include "snow/texels/sheets.h"

namespace snowbough::snow {
namespace {

void add_triangles(const SceneObject& object, uint32_t slot, uint32_t& first_sheet,
                   SceneLayout& layout) {
  const MapTopology& topology = object.description.topology;
  layout.first_vertex.push_back(layout.vertex_count);
  layout.first_triangle.push_back(static_cast<int32_t>(layout.triangles.size()));
  const auto base = static_cast<uint32_t>(layout.vertex_count);
  const uint32_t owner = slot | (object.description.receive ? shared::kReceives : 0u);
  for (size_t t = 0; t + 2 < topology.triangles.size(); t += 3) {
    const bool two_sided = !object.two_sided.empty() && object.two_sided[t / 3] != 0;
    layout.triangles.push_back({base + static_cast<uint32_t>(topology.triangles[t]),
                                base + static_cast<uint32_t>(topology.triangles[t + 1]),
                                base + static_cast<uint32_t>(topology.triangles[t + 2]),
                                owner | (two_sided ? shared::kTwoSided : 0u)});
  }
  layout.vertex_count += static_cast<int32_t>(object.positions.size());
  const Sheets sheets = find_sheets(topology.triangles, topology.vertex_count);
  for (const int32_t sheet : sheets.sheet) {
    layout.triangle_sheets.push_back(first_sheet + static_cast<uint32_t>(sheet));
  }
  first_sheet += static_cast<uint32_t>(sheets.count);
}

void add_map_triangles(const SceneObject& object, size_t slot, int32_t first_triangle,
                       SceneLayout& layout) {
  layout.map_offsets[slot] = static_cast<int32_t>(layout.map_triangles.size()) - first_triangle;
  for (int32_t t = 0; t < object.triangle_count(); ++t) {
    const glm::vec2* uv = &object.description.topology.corner_uv[3 * static_cast<size_t>(t)];
    layout.map_triangles.push_back({uv[0], uv[1], uv[2], {}});
  }
}

void add_alpha(const std::vector<const SceneObject*>& objects, SceneLayout& layout) {
  std::map<const AlphaMask*, uint32_t> numbers;  // never iterated over
  for (const SceneObject* object : objects) {
    const ObjectAlpha& alpha = object->description.alpha;
    layout.first_alpha.push_back(
        alpha.empty() ? -1 : static_cast<int32_t>(layout.alpha_triangles.size()));
    std::vector<uint32_t> number_of;
    for (const std::shared_ptr<const AlphaMask>& mask : alpha.masks) {
      const auto number = static_cast<uint32_t>(layout.alpha_headers.size() + 1);
      const auto [known, is_new] = numbers.emplace(mask.get(), number);
      if (is_new) {
        layout.alpha_headers.push_back({static_cast<uint32_t>(layout.alpha_bits.size()),
                                        static_cast<uint32_t>(mask->width),
                                        static_cast<uint32_t>(mask->height), mask->extension});
        layout.alpha_bits.insert(layout.alpha_bits.end(), mask->bits.begin(), mask->bits.end());
      }
      number_of.push_back(known->second);
    }
    for (size_t t = 0; t < alpha.mask.size(); ++t) {
      const glm::vec2* uv = &alpha.corner_uv[3 * t];
      const int32_t mask = alpha.mask[t];
      layout.alpha_triangles.push_back(
          {uv[0], uv[1], uv[2], mask < 0 ? 0u : number_of[static_cast<size_t>(mask)], 0u});
    }
  }
}

}  // namespace

std::vector<size_t> objects_by_slot(const MapPlan& plan) {
  std::vector<size_t> objects(plan.slot.size());
  for (size_t i = 0; i < plan.slot.size(); ++i) objects[static_cast<size_t>(plan.slot[i])] = i;
  return objects;
}

SceneLayout lay_out_scene(const std::vector<const SceneObject*>& objects, int32_t max_layers) {
  SceneLayout layout;
  layout.plan = plan_maps(objects, max_layers);
  uint32_t first_sheet = 0;
  for (size_t i = 0; i < objects.size(); ++i) {
    add_triangles(*objects[i], static_cast<uint32_t>(layout.plan.slot[i]), first_sheet, layout);
  }
  layout.map_offsets.assign(objects.size(), 0);
  const std::vector<size_t> by_slot = objects_by_slot(layout.plan);
  for (size_t slot = 0; slot < by_slot.size(); ++slot) {
    const SceneObject& object = *objects[by_slot[slot]];
    if (object.description.receive) {
      add_map_triangles(object, slot, layout.first_triangle[by_slot[slot]], layout);
    }
  }
  add_alpha(objects, layout);
  layout.smooth_points = find_smooth_points(objects);
  return layout;
}

}  // namespace snowbough::snow
