#include "snow/step/cpu/scene.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "base/parallel_for.h"
#include "snow/texels/texel_order.h"

namespace snowbough::snow::cpu {
namespace {

/// The texels and fragments of a receiver, in the order of the passes.
void set_texels(const SceneObject& object, uint32_t first_triangle, Receiver& receiver) {
  const std::vector<int32_t> order = texel_order(*object.table);
  std::vector<uint32_t> places;
  places.reserve(order.size());
  for (const int32_t i : order) {
    places.push_back(static_cast<uint32_t>(object.table->texel[static_cast<size_t>(i)]));
  }
  receiver.own_places = std::make_shared<const std::vector<uint32_t>>(std::move(places));
  receiver.places = *receiver.own_places;
  receiver.fragments = make_fragment_runs(object, order, first_triangle);
}

/// The data of the step, and a bare map.
void set_bare(int32_t resolution, Receiver& receiver) {
  receiver.resolution = resolution;
  receiver.steps = TexelSteps(receiver.places.size());
  receiver.height.assign(static_cast<size_t>(resolution) * static_cast<size_t>(resolution), 0.0f);
  // Until the first step has checked, any of them may hold snow.
  const size_t groups = receiver.fragments.group_begin.size() - 1;
  receiver.holds_snow.assign(groups, 1);
  receiver.evaluated_in.assign(groups, 0);
}

/// Per slot: the first slot whose receiver has an equal texel table and opacity.
std::vector<size_t> find_equals(const std::vector<const SceneObject*>& objects,
                                const std::vector<size_t>& by_slot, size_t receivers) {
  std::map<const TexelTable*, size_t> first;  // never iterated over
  std::vector<size_t> equal(receivers);
  for (size_t slot = 0; slot < receivers; ++slot) {
    const SceneObject& own = *objects[by_slot[slot]];
    const size_t other = first.emplace(own.table.get(), slot).first->second;
    const bool is_equal = own.fragment_opacity == objects[by_slot[other]]->fragment_opacity;
    equal[slot] = is_equal ? other : slot;
  }
  return equal;
}

}  // namespace

Scene build_scene(const std::vector<const SceneObject*>& objects) {
  Scene scene;
  scene.layout = lay_out_scene(objects, std::numeric_limits<int32_t>::max());
  scene.positions.resize(static_cast<size_t>(scene.layout.vertex_count));
  scene.corners.resize(3 * scene.layout.triangles.size());
  scene.surface.resize(scene.layout.triangles.size());
  scene.point_normals.resize(scene.layout.smooth_points.count());
  scene.smooth_points.resize(scene.layout.smooth_points.count());
  scene.back_pixels.assign(objects.size(), 0);
  const std::vector<size_t> by_slot = objects_by_slot(scene.layout.plan);
  const auto receivers = static_cast<size_t>(std::count_if(
      objects.begin(), objects.end(), [](const SceneObject* o) { return o->description.receive; }));
  scene.receivers.resize(receivers);
  const std::vector<size_t> equal = find_equals(objects, by_slot, receivers);
  const auto first_triangle = [&](size_t slot) {
    return static_cast<uint32_t>(scene.layout.first_triangle[by_slot[slot]]);
  };
  base::for_each_item(receivers, 1, [&](size_t slot) {
    if (equal[slot] != slot) return;
    set_texels(*objects[by_slot[slot]], first_triangle(slot), scene.receivers[slot]);
  });
  base::for_each_item(receivers, 1, [&](size_t slot) {
    Receiver& receiver = scene.receivers[slot];
    if (equal[slot] != slot) {
      const Receiver& other = scene.receivers[equal[slot]];
      receiver.own_places = other.own_places;
      receiver.places = other.places;
      receiver.fragments =
          with_own_triangles(other.fragments, first_triangle(slot) - first_triangle(equal[slot]));
    }
    set_bare(objects[by_slot[slot]]->table->resolution, receiver);
    receiver.object = by_slot[slot];
    receiver.slot = static_cast<uint32_t>(slot);
    receiver.map_offset = scene.layout.map_offsets[slot];
  });
  return scene;
}

}  // namespace snowbough::snow::cpu
