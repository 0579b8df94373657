#include "snow/step/cpu/engine.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "shaders/lib/object_sums.h"
#include "snow/repose/pass.h"
#include "snow/scene/memory_estimate.h"
#include "snow/step/cpu/occlusion/occlusion.h"
#include "snow/step/cpu/passes.h"
#include "snow/step/cpu/run_visibility.h"
#include "snow/step/cpu/scene.h"

namespace snowbough::snow::cpu {
namespace {

#if defined(__x86_64__) || defined(_M_X64)
constexpr const char* kFamily = "x86-64";
#elif defined(__aarch64__) || defined(_M_ARM64)
constexpr const char* kFamily = "arm64";
#else
constexpr const char* kFamily = "other";
#endif

class CpuEngine final : public Engine {
 public:
  EngineKind kind() const override { return EngineKind::kCpu; }
  std::string driver() const override { return std::string("processor, ") + kFamily; }
  int64_t free_memory() override { return machine_memory(); }
  int32_t max_layers() const override { return std::numeric_limits<int32_t>::max(); }
  void run(const std::function<void()>& work) override { work(); }

  void build_scene(const std::vector<const SceneObject*>& objects) override {
    pending_tile_.reset();
    scene_ = Scene{};
    scene_ = cpu::build_scene(objects);
    repose_.lay_out(objects);
  }
  void set_positions(size_t object, const std::vector<glm::vec3>& positions) override {
    std::copy(positions.begin(), positions.end(),
              scene_.positions.begin() + scene_.layout.first_vertex[object]);
    scene_.normals_are_current = false;
    if (scene_.layout.plan.group[object] >= 0) ++receiver_of(object).pose;
    repose_.forget_pose(object);
  }

  void set_up_triangles(const shared::ProjectionFrame& frame) override {
    scene_.frame = frame;
    cpu::set_up_triangles(scene_.positions, scene_.layout.triangles, frame, scene_.corners,
                          scene_.surface);
    cpu::set_up_smooth_points(scene_);
  }
  void choose_texels() override { cpu::choose_texels(scene_); }
  void open_statistics() override {
    std::fill(scene_.back_pixels.begin(), scene_.back_pixels.end(), 0u);
    for (Receiver& receiver : scene_.receivers) receiver.sums = shared::opened(receiver.sums);
  }
  void evaluate_texels() override { cpu::evaluate_texels(scene_); }
  void render_occlusion(const Tile& tile, const std::vector<TriangleRange>& ranges) override {
    gather_waiting();
    const PixelRect pixels = tile.with_margin();
    const auto count = static_cast<size_t>(pixels.size().x) * static_cast<size_t>(pixels.size().y);
    if (scene_.seen.size() < count + kSeenSpare) scene_.seen.resize(count + kSeenSpare);
    const SceneLayout& layout = scene_.layout;
    occlusion_.run(
        {scene_.corners, ranges, {layout.alpha_triangles, layout.alpha_places, layout.alpha_bits}},
        pixels, std::span(scene_.seen).first(count));
  }
  void count_back_faces(const Tile& tile) override { cpu::count_back_faces(scene_, tile); }
  void gather_deposit(const Tile& tile, bool is_first) override {
    pending_tile_ = {tile, is_first};
  }
  void apply_stability(const StabilitySettings& settings, float full_gain, float dt) override {
    const GroupWork last = pending_tile_
                               ? deposit_work(scene_, pending_tile_->tile, pending_tile_->is_first)
                               : GroupWork();
    pending_tile_.reset();
    cpu::apply_stability(scene_, settings, full_gain, dt, last);
  }
  void apply_repose(const ReposeSettings& settings, float dt) override {
    std::vector<ReposePass::Map> maps;
    for (Receiver& receiver : scene_.receivers) {
      maps.push_back({receiver.object, &receiver.height});
    }
    repose_.run(settings, dt, maps);
    for (size_t slot = 0; slot < maps.size(); ++slot) {
      if (!maps[slot].has_changed) continue;
      Receiver& receiver = scene_.receivers[slot];
      receiver.sums.slid += maps[slot].slid;
      receiver.sums.held -= maps[slot].slid;
      cpu::find_snow(receiver);
    }
  }
  void close_statistics(float pixel_area) override {
    for (Receiver& receiver : scene_.receivers) {
      receiver.sums = shared::closed(receiver.sums, scene_.back_pixels[receiver.slot], pixel_area);
    }
  }

  void read_height(size_t object, std::vector<float>& height) override {
    height = receiver_of(object).height;
  }
  void write_height(size_t object, const std::vector<float>& height) override {
    Receiver& receiver = receiver_of(object);
    receiver.height = height;
    std::fill(receiver.holds_snow.begin(), receiver.holds_snow.end(), uint8_t{1});
  }
  std::vector<glm::vec4> read_triangles(const TriangleRange& range) override {
    const auto corners = scene_.corners.begin() + 3 * ptrdiff_t{range.first};
    const auto surface = scene_.surface.begin() + range.first;
    std::vector<glm::vec4> data(corners, corners + 3 * ptrdiff_t{range.count});
    data.insert(data.end(), surface, surface + range.count);
    return data;
  }
  std::vector<shared::SeenPixel> read_occlusion(const Tile& tile) override {
    const glm::ivec2 size = tile.with_margin().size();
    return {scene_.seen.begin(), scene_.seen.begin() + ptrdiff_t{size.x} * size.y};
  }
  std::vector<TexelGain> read_gains(size_t object) override {
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
  shared::ObjectSums read_sums(size_t object) override { return receiver_of(object).sums; }
  void write_sums(size_t object, const shared::ObjectSums& sums) override {
    receiver_of(object).sums = sums;
  }
  const SceneLayout& layout() const override { return scene_.layout; }

 private:
  Receiver& receiver_of(size_t object) {
    return scene_.receivers[static_cast<size_t>(scene_.layout.plan.slot[object])];
  }

  void gather_waiting() {
    if (pending_tile_) cpu::gather_deposit(scene_, pending_tile_->tile, pending_tile_->is_first);
    pending_tile_.reset();
  }

  /// The tile whose deposit is not gathered yet: the step's last tile, usually the only one, is
  /// gathered together with stability, group by group.
  struct PendingTile {
    Tile tile;
    bool is_first;
  };
  std::optional<PendingTile> pending_tile_;
  Scene scene_;
  OcclusionPass occlusion_;
  ReposePass repose_;
};

}  // namespace

std::unique_ptr<Engine> make_engine() {
  return std::make_unique<CpuEngine>();
}

}  // namespace snowbough::snow::cpu
