#include "snow/step/cpu/engine.h"

#include <algorithm>
#include <utility>

#include "snow/step/cpu/passes.h"
#include "snow/step/cpu/run_visibility.h"

namespace snowbough::snow::cpu {
namespace {

#if defined(__x86_64__) || defined(_M_X64)
constexpr const char* kFamily = "x86-64";
#elif defined(__aarch64__) || defined(_M_ARM64)
constexpr const char* kFamily = "arm64";
#else
constexpr const char* kFamily = "other";
#endif

}  // namespace

std::string CpuEngine::driver() const {
  return std::string("processor, ") + kFamily;
}

MemoryEstimate CpuEngine::memory(const std::vector<const SceneObject*>& objects,
                                 int32_t tile_size) const {
  constexpr int64_t kPerTexel = 4 + 4 + sizeof(shared::TexelStep);
  // 18, and a share of a run of 32 for some eight fragments.
  constexpr int64_t kPerFragment = 18 + 4;
  MemoryEstimate estimate = estimate_shared_memory(objects);
  for (const SceneObject* object : objects) {
    if (!object->description.receive) continue;
    const int64_t group = shared::kTexelGroup;
    const int64_t texels =
        (static_cast<int64_t>(object->table->texel.size()) + group - 1) / group * group;
    estimate.texels += texels * kPerTexel + texels / group * (16 + 4 * 4) +
                       int64_t{2} * 4 * object->triangle_count() +
                       kPerFragment * static_cast<int64_t>(object->table->fragment_triangle.size());
  }
  // The pixels of a tile, and the bins of its triangles.
  estimate.tile =
      int64_t{tile_size} * tile_size * static_cast<int64_t>(2 * sizeof(shared::SeenPixel) + 4);
  return estimate;
}

void CpuEngine::build_scene(const std::vector<const SceneObject*>& objects) {
  pending_tile_.reset();
  scene_ = Scene{};
  scene_ = cpu::build_scene(objects);
}

void CpuEngine::set_positions(size_t object, const std::vector<glm::vec3>& positions) {
  std::copy(positions.begin(), positions.end(),
            scene_.positions.begin() + scene_.layout.first_vertex[object]);
  scene_.normals_are_current = false;
  if (scene_.layout.plan.group[object] < 0) return;
  Receiver& receiver = receiver_of(object);
  ++receiver.pose;
  receiver.bounds = {};
  for (const glm::vec3& position : positions) receiver.bounds.include(glm::dvec3(position));
}

void CpuEngine::render_occlusion(const Tile& tile, const std::vector<TriangleRange>& ranges) {
  if (pending_tile_) cpu::gather_deposit(scene_, pending_tile_->tile, pending_tile_->is_first);
  pending_tile_.reset();
  const PixelRect pixels = tile.with_margin();
  const auto count = static_cast<size_t>(pixels.size().x) * static_cast<size_t>(pixels.size().y);
  if (scene_.seen.size() < count + kSeenSpare) scene_.seen.resize(count + kSeenSpare);
  const SceneLayout& layout = scene_.layout;
  occlusion_.run(
      {scene_.corners, ranges, {layout.alpha_triangles, layout.alpha_headers, layout.alpha_bits}},
      pixels, std::span(scene_.seen).first(count));
}

void CpuEngine::move_snow(const std::function<void(std::vector<MovingMap>&)>& move) {
  std::vector<MovingMap> maps;
  for (Receiver& receiver : scene_.receivers) {
    MovingMap& map = maps.emplace_back(receiver.object, &receiver.height);
    for (const uint32_t group : receiver.slid_groups) {
      for (size_t i = receiver.first_texel(group); i < receiver.first_texel(group + 1); ++i) {
        const float slid = std::exchange(receiver.slid[i], 0.0f);
        if (slid > 0.0f) map.slid_from.emplace_back(static_cast<int32_t>(receiver.places[i]), slid);
      }
    }
    receiver.slid_groups.clear();
  }
  move(maps);
  for (size_t slot = 0; slot < maps.size(); ++slot) {
    Receiver& receiver = scene_.receivers[slot];
    receiver.sums.slid += maps[slot].slid;
    receiver.sums.held -= maps[slot].slid;
    receiver.sums.landed += maps[slot].landed;
    count_removed(maps[slot], receiver.sums);
    if (maps[slot].has_changed) cpu::find_snow(receiver);
  }
}

void CpuEngine::write_height(size_t object, const std::vector<float>& height) {
  Receiver& receiver = receiver_of(object);
  receiver.height = height;
  std::fill(receiver.holds_snow.begin(), receiver.holds_snow.end(), uint8_t{1});
}

std::vector<glm::vec4> CpuEngine::read_triangles(const TriangleRange& range) {
  const auto corners = scene_.corners.begin() + 3 * ptrdiff_t{range.first};
  const auto surface = scene_.surface.begin() + range.first;
  std::vector<glm::vec4> data(corners, corners + 3 * ptrdiff_t{range.count});
  data.insert(data.end(), surface, surface + range.count);
  return data;
}

std::vector<shared::SeenPixel> CpuEngine::read_occlusion(const Tile& tile) {
  const glm::ivec2 size = tile.with_margin().size();
  return {scene_.seen.begin(), scene_.seen.begin() + ptrdiff_t{size.x} * size.y};
}

std::vector<TexelGain> CpuEngine::read_gains(size_t object) {
  const Receiver& receiver = receiver_of(object);
  std::vector<TexelGain> gains;
  for (const uint32_t group : receiver.active) {
    for (size_t i = receiver.first_texel(group); i < receiver.first_texel(group + 1); ++i) {
      if (receiver.steps.gain[i] == 0) continue;
      gains.push_back({receiver.places[i], receiver.steps.gain[i]});
    }
  }
  return gains;
}

std::unique_ptr<Engine> make_engine() {
  return std::make_unique<CpuEngine>();
}

}  // namespace snowbough::snow::cpu
