#pragma once

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/parallel_for.h"
#include "snow/movement/rays/scene_rays.h"
#include "snow/movement/repose/choice.h"
#include "snow/movement/repose/ground.h"
#include "snow/movement/repose/outlets.h"
#include "snow/movement/repose/releases.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// Steepest slope of the snow's own surface.
struct ReposeSettings {
  /// Angle of repose in radians from level; from kOff on snow stays where it fell, to the bit.
  double angle = 1.5707963267948966;
  /// Height in metres at which a vertical snow face stays up; 0: no cohesion.
  double cohesion = 0.0;
  /// See ReposeLimits.
  bool is_granular = false;
  static constexpr double kOff = 1.5706;
  bool is_on() const { return angle < kOff; }
};

/// Calls work(i) for i from 0 to count - 1.
template <typename Work>
void for_each_block(size_t count, bool on_all_cores, const Work& work) {
  // Waking another thread takes about as long as a few rounds of a block.
  constexpr size_t kFew = 3;
  base::for_each_item(count, 1, work, on_all_cores && count > kFew ? base::default_threads() : 1);
}

/// Where snow stands whatever its slope.
struct ReposeStand {
  /// By place, to which height in metres; null: nowhere.
  const std::vector<float>* height = nullptr;
  /// By block: whether that has changed; empty: nowhere.
  std::vector<uint8_t> changed;
};

/// What a run of repose has moved.
struct ReposeResult {
  /// Volume that fell over open edges and off walls, in m3; and where, if it is to be listed.
  double fallen = 0.0;
  std::vector<Release> releases;
  /// Whether heights changed.
  bool has_changed = false;
  /// Number of rounds that the blocks took together.
  double rounds = 0.0;
};

/// Repose on one receiver's map: snow whose surface is steeper than the angle of repose moves to
/// lower neighbours (shaders/lib/texel_repose.h has the method), over seams and over open edges
/// into the air, until it rests or the step's work limit is reached; the rest moves in the next
/// step. The heights are its only state.
///
/// The map is divided into blocks. Blocks in which nothing can be steep are skipped, which the
/// range of heights shows while the surface does not move. The others run some rounds at a time
/// within the cache, every second one of a row and a column at once; then snow flows across seams.
/// The number of threads does not change the result.
class Repose {
 public:
  /// `object` must have positions; both must outlive it.
  /// `rays` find the room above sheltered texels; null: it is not limited.
  /// `coarse`: the texels of a coarser map of the object, which nobody shares; null: its own map.
  Repose(const SceneObject& object, ReposeLinkTables& tables, const SceneRays* rays = nullptr,
         std::shared_ptr<const TexelTable> coarse = nullptr)
      : ground_(object, tables, std::move(coarse)), rays_(rays) {}

  /// The texels of its map.
  const TexelTable& table() const { return ground_.table(); }

  /// Call it when the object's positions have changed.
  void forget_pose() { ground_.has_pose = false; }
  /// Call it when an object near this one has moved.
  void forget_rooms();
  /// Releases memory that the next step would reuse.
  void forget_tiles();

  /// What the snow lies on, in the current pose; and the bare surface of its texels, which the
  /// first call in a pose evaluates.
  ReposeGround& ground() {
    if (!ground_.has_pose) update_pose();
    return ground_;
  }
  const BareTexels& bare() { return bare_texels(ground()); }
  /// After the first pose.
  const ReposeLinks& links() const { return *ground_.links; }

  /// Selects the blocks in which snow may move, by their heights; returns their number. `blades`:
  /// blocks, ascending, in which objects have just pushed snow ahead; it moves there for a few
  /// rounds. `only_there`: it moves nowhere else, and none is cut above outlets. `within`: by
  /// block, whether snow may move from it; empty: from all.
  size_t choose_blocks(const std::vector<float>& height, const ReposeLimits& limits,
                       const std::vector<int32_t>& blades = {}, bool only_there = false,
                       const std::vector<uint8_t>& within = {});

  /// Of `stand`: nothing passes.
  static constexpr float kBarrier = 1000.0f;
  /// Sets the height in metres to which snow stands at each place whatever its slope, until the
  /// next call; null: nowhere. `changed`: by block, whether any place has another height than in
  /// the last call; empty: none has.
  void set_stand(const std::vector<float>* stand, const std::vector<uint8_t>& changed) {
    stand_ = {stand, changed};
  }

  /// Prepares those blocks. `on_all_cores`: share the work among threads.
  void set_up(const std::vector<float>& height, bool on_all_cores);

  /// Between set_up and run: the choice, and the blocks, whose outlets' `top` may be raised.
  const ReposeChoice& choice() const { return choice_; }
  ReposeBlocks& blocks() { return blocks_; }

  /// Moves snow on `height` in those blocks. `dt`: seconds; a long step may run more rounds.
  /// `on_all_cores`: as for set_up.
  ReposeResult run(std::vector<float>& height, float dt, bool on_all_cores, bool lists_releases);

 private:
  using Blocks = std::vector<int32_t>;
  /// One flag per block of the map.
  using Marks = std::vector<uint8_t>;

  void update_pose();
  bool begin_choice(const std::vector<float>& height, const ReposeLimits& limits);
  void reuse_tiles(Marks& changes);
  bool cover_tile(int32_t block, const std::vector<float>& height);

  ReposeGround ground_;
  const SceneRays* rays_;
  ReposeChoice choice_;
  ReposeBlocks blocks_;
  ReposeStand stand_;
};

}  // namespace snowbough::snow
