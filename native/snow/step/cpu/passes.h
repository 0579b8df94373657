#pragma once

#include <algorithm>
#include <functional>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/parallel_for.h"
#include "shaders/lib/object_sums.h"
#include "shaders/lib/snow_shared.h"
#include "snow/scene/projection.h"
#include "snow/step/cpu/occlusion/occlusion.h"
#include "snow/step/cpu/scene.h"
#include "snow/step/engine/engine.h"

// The passes of a step on the CPU, in their order, and the engine that runs them. The OcclusionPass
// in step/cpu/occlusion/occlusion.h draws the surfaces that the sky sees. Each pass has a source of
// its name.
namespace snowbough::snow::cpu {

/// Evaluates every triangle on the current vertices as seen along this step's fall: corners in grid
/// pixels with depth, slopes, area (shaders/lib/triangle_setup.h). It runs first; all other passes
/// read its result instead of the vertices. Runs on all cores; callable from any thread.
/// `positions` in metres; `corners` receives three elements per triangle and `surface` one.
/// @throws std::invalid_argument if their sizes differ from that.
void set_up_triangles(std::span<const glm::vec3> positions,
                      std::span<const shared::SceneTriangle> triangles,
                      const shared::ProjectionFrame& frame, std::span<glm::vec4> corners,
                      std::span<glm::vec4> surface);

/// Evaluates the surface at the points of smooth-shaded surfaces, from this step's triangles
/// (shaders/lib/smooth_points.h).
void set_up_smooth_points(Scene& scene);

/// Selects the active groups of texels: groups that hold snow or have a triangle that faces the
/// fall. The passes would change nothing in the others.
void choose_texels(Scene& scene);

/// Updates which groups hold snow, after snow has moved.
void find_snow(Receiver& receiver);

/// Evaluates area and upward parts of a group's texels, and each fragment's share of them, on the
/// current triangles, unless that was done in this pose.
void evaluate_group(const Scene& scene, Receiver& receiver, size_t group);

/// Calls work(receiver, number of one of its active groups) for all of them, in one loop: the
/// threads would wait for each other after each of many small receivers.
template <typename Work>
void for_active_groups(Scene& scene, const Work& work) {
  std::vector<size_t> begin{0};
  for (const Receiver& receiver : scene.receivers) {
    begin.push_back(begin.back() + receiver.active.size());
  }
  base::for_each_item(begin.back(), 4, [&](size_t i) {
    const auto after = std::upper_bound(begin.begin(), begin.end(), i);
    const auto r = static_cast<size_t>(after - begin.begin()) - 1;
    work(scene.receivers[r], i - begin[r]);
  });
}

/// Evaluates area and upward parts of the active texels on the current triangles, for steps without
/// snowfall; sets their gain to 0.
void evaluate_texels(Scene& scene);

/// Counts, per receiver, the tile's own pixels in which the sky sees back faces of surfaces that
/// gather nothing: a high count suggests flipped normals.
void count_back_faces(Scene& scene, const Tile& tile);

/// Gathers the deposit of a tile at the active texels (shaders/lib/texel_gain.h has the method):
/// adds it to `gain` of their steps, or sets it in the first tile of the step that shows their
/// receiver, after evaluate_group. The
/// scene's `seen` shows the tile and its margin, plus kSeenSpare pixels. The result is
/// bit-identical to evaluating fragments one by one.
void gather_deposit(Scene& scene, const Tile& tile, bool is_first);

/// Work on one group of a receiver's texels, for any thread.
using GroupWork = std::function<void(Receiver& receiver, size_t group)>;

/// gather_deposit for a single group, in the step's last tile: it also sets the gain of receivers
/// that no tile shows. `scene` and its content must not change meanwhile.
GroupWork deposit_work(Scene& scene, const Tile& tile, bool is_first);

/// Adds the active texels' deposit to their heights and lets snow beyond the slope's capacity
/// slide, in closed form over `dt` seconds (shaders/lib/texel_stability.h has the method); sums
/// each receiver's volumes and visible area in a fixed order. `before` is called for each group
/// just before, so that its results are still in the cache.
void apply_stability(Scene& scene, const StabilitySettings& settings, float full_gain, float dt,
                     const GroupWork& before = {});

/// See make_engine (step/cpu/engine.h).
class CpuEngine final : public Engine {
 public:
  EngineKind kind() const override { return EngineKind::kCpu; }
  std::string driver() const override;
  int64_t free_memory() override { return machine_memory(); }
  MemoryEstimate memory(const std::vector<const SceneObject*>& objects,
                        int32_t tile_size) const override;
  void run(const std::function<void()>& work) override { work(); }

  void build_scene(const std::vector<const SceneObject*>& objects) override;
  void set_positions(size_t object, const std::vector<glm::vec3>& positions) override;

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
  void render_occlusion(const Tile& tile, const std::vector<TriangleRange>& ranges) override;
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
  void move_snow(const std::function<void(std::vector<MovingMap>&)>& move) override;
  void close_statistics(float pixel_area) override {
    for (Receiver& receiver : scene_.receivers) {
      receiver.sums = shared::closed(receiver.sums, scene_.back_pixels[receiver.slot], pixel_area);
    }
  }

  void read_height(size_t object, std::vector<float>& height) override {
    height = receiver_of(object).height;
  }
  void write_height(size_t object, const std::vector<float>& height) override;
  std::vector<glm::vec4> read_triangles(const TriangleRange& range) override;
  std::vector<shared::SeenPixel> read_occlusion(const Tile& tile) override;
  std::vector<TexelGain> read_gains(size_t object) override;
  shared::ObjectSums read_sums(size_t object) override { return receiver_of(object).sums; }
  void write_sums(size_t object, const shared::ObjectSums& sums) override {
    receiver_of(object).sums = sums;
  }
  const SceneLayout& layout() const override { return scene_.layout; }

 private:
  Receiver& receiver_of(size_t object) {
    return scene_.receivers[static_cast<size_t>(scene_.layout.plan.slot[object])];
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
};

}  // namespace snowbough::snow::cpu
