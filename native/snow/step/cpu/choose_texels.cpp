#include <algorithm>

#include "base/parallel_for.h"
#include "shaders/lib/facing.h"
#include "snow/step/cpu/passes.h"

namespace snowbough::snow::cpu {
namespace {

bool faces_the_fall(const Scene& scene, const FragmentRuns& fragments, size_t group) {
  const auto begin = fragments.runs.begin() + fragments.group_begin[group];
  const auto end = fragments.runs.begin() + fragments.group_begin[group + 1];
  return std::any_of(begin, end, [&](const FragmentRuns::Run& run) {
    return shared::may_face_the_fall(shared::surface_facing(scene.surface[run.triangle]));
  });
}

}  // namespace

void choose_texels(Scene& scene) {
  base::for_each_item(scene.receivers.size(), 1, [&](size_t r) {
    Receiver& receiver = scene.receivers[r];
    receiver.active.clear();
    for (size_t group = 0; group < receiver.group_count(); ++group) {
      if (receiver.holds_snow[group] != 0 || faces_the_fall(scene, receiver.fragments, group)) {
        receiver.active.push_back(static_cast<uint32_t>(group));
        receiver.holds_snow[group] = 0;
      }
    }
  });
}

void find_snow(Receiver& receiver) {
  base::for_each_item(receiver.group_count(), 64, [&](size_t group) {
    uint8_t& holds = receiver.holds_snow[group];
    const size_t end = receiver.first_texel(group + 1);
    for (size_t i = receiver.first_texel(group); i < end && holds == 0; ++i) {
      holds = receiver.height[receiver.places[i]] != 0.0f ? 1 : 0;
    }
  });
}

}  // namespace snowbough::snow::cpu
