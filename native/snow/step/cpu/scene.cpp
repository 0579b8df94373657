#include "snow/step/cpu/scene.h"

#include <algorithm>
#include <limits>

#include "base/parallel_for.h"
#include "snow/texels/texel_order.h"

namespace snowbough::snow::cpu {
namespace {

Receiver make_receiver(const SceneObject& object, uint32_t first_triangle) {
  Receiver receiver;
  receiver.resolution = object.table.resolution;
  const std::vector<int32_t> order = texel_order(object.table);
  receiver.places.reserve(order.size());
  for (const int32_t i : order) {
    receiver.places.push_back(static_cast<uint32_t>(object.table.texel[static_cast<size_t>(i)]));
  }
  receiver.fragments = make_fragment_runs(object, order, first_triangle);
  receiver.steps = TexelSteps(receiver.places.size());
  receiver.height.assign(
      static_cast<size_t>(receiver.resolution) * static_cast<size_t>(receiver.resolution), 0.0f);
  // Until the first step has checked, any of them may hold snow.
  const size_t groups = receiver.fragments.group_begin.size() - 1;
  receiver.holds_snow.assign(groups, 1);
  receiver.evaluated_in.assign(groups, 0);
  return receiver;
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
  base::for_each_item(receivers, 1, [&](size_t slot) {
    const size_t object = by_slot[slot];
    const auto first = static_cast<uint32_t>(scene.layout.first_triangle[object]);
    Receiver& receiver = scene.receivers[slot];
    receiver = make_receiver(*objects[object], first);
    receiver.object = object;
    receiver.slot = static_cast<uint32_t>(slot);
    receiver.map_offset = scene.layout.map_offsets[slot];
  });
  return scene;
}

}  // namespace snowbough::snow::cpu
