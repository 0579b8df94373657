#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/parallel_for.h"
#include "snow/movement/rays/map_point.h"
#include "snow/movement/rays/object_rays.h"
#include "snow/movement/rays/scene_rays.h"
#include "snow/movement/repose/links.h"
#include "snow/movement/repose/pose.h"
#include "snow/movement/repose/slack.h"
#include "snow/movement/repose/surface.h"
#include "snow/movement/repose/tile.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

struct TilesAround;

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

/// Repose on one receiver's map: snow whose surface is steeper than the angle of repose moves to
/// lower neighbours (shaders/lib/texel_repose.h has the method), over seams and over rims into the
/// air, until it rests or the step's work limit is reached; the rest moves in the next step. The
/// heights are its only state.
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
      : object_(&object),
        coarse_(std::move(coarse)),
        link_tables_(&tables),
        rays_(rays),
        own_rays_(object) {}

  /// The texels of its map.
  const TexelTable& table() const { return *shared_table(); }

  /// Call it when the object's positions have changed.
  void forget_pose() { has_pose_ = false; }
  /// Call it when an object near this one has moved.
  void forget_rooms();
  /// Releases memory that the next step would reuse.
  void forget_tiles();

  /// Selects the blocks in which snow may move, by their heights; returns their number. `blades`:
  /// blocks, ascending, in which objects have just pushed snow ahead; it moves there for a few
  /// rounds. `only_there`: it moves nowhere else, and none is cut above outlets.
  size_t choose_blocks(const std::vector<float>& height, const ReposeLimits& limits,
                       const std::vector<int32_t>& blades = {}, bool only_there = false);

  /// Sets the height in metres to which snow stands at each place whatever its slope, until the
  /// next call; null: nowhere. `changed`: by block, whether any place has another height than in
  /// the last call; empty: none has.
  void set_stand(const std::vector<float>* stand, const std::vector<uint8_t>& changed) {
    stand_ = stand;
    restands_ = changed;
  }

  /// Prepares those blocks. `on_all_cores`: share the work of this call and of `run` among threads.
  void set_up(const std::vector<float>& height, bool on_all_cores);

  /// The end of the surface at an outlet, in the world.
  struct Outlet {
    glm::dvec3 point{0.0};
    /// Horizontal unit vector away from the surface, or 0.
    glm::dvec2 outwards{0.0};
    /// Half a texel, in metres.
    double reach = 0.0;
    /// Whether it is above a wall in the same chart.
    bool is_wall = false;
  };
  /// Between set_up and run: the chosen blocks; a block's outlets, whose `top` may be raised; and
  /// properties of one of them. Heights are in metres.
  const std::vector<int32_t>& chosen() const { return chosen_; }
  std::vector<RimLink>& outlets_of(int32_t block) { return rims_[static_cast<size_t>(block)]; }
  size_t block_count() const { return links_->block_count(); }
  size_t outlet_count() const { return across_.size() + links_->rims.size(); }
  Outlet outlet(const RimLink& rim) const;
  /// The highest snow in a block and its neighbours at the start of the step.
  float highest_near(int32_t block) const;
  bool is_below_snow(int32_t block, const RimLink& rim) const;
  /// Height of the snow's surface above the outlet.
  float top_over(int32_t block, const RimLink& rim) const;

  /// Moves snow on `height` in those blocks. `dt`: seconds; a long step may run more rounds.
  /// `lists_releases`: for take_releases. Returns the volume that fell over rims and off walls, in
  /// m3.
  double run(std::vector<float>& height, float dt, bool lists_releases);

  /// Snow that left the map in a run.
  struct Release {
    static constexpr int32_t kOffWall = -1;
    static constexpr int32_t kInHollow = -2;
    static constexpr int32_t kThrough = -3;
    /// The outlet over which it fell, see RimLink::number; or one of these: it fell off a wall,
    /// found no way out of a hollow, or falls through the surface that let it go.
    int32_t outlet = kOffWall;
    /// The outlet's texel, the wall's, or the hollow's lowest.
    int32_t texel = 0;
    /// In m3.
    double volume = 0.0;
  };
  /// What was released since the last call.
  std::vector<Release> take_releases() { return std::exchange(releases_, {}); }
  /// The bare surface of all texels in the current pose, up to a translation and a rotation about
  /// the vertical.
  struct BareTexels {
    /// By place on the map; -1: none.
    std::vector<int32_t> texel_of;
    /// By texel: metres, upward part of the normal, m2.
    std::vector<float> x, y, z, up, area;
  };
  /// The first call in a pose evaluates it.
  const BareTexels& bare_texels();
  /// After bare_texels.
  const ReposeLinks& links() const { return *links_; }
  /// Where snow on a texel ends if it slides down the bare surface.
  Release way_down(int32_t texel);

  /// The next texel straight down the bare surface; or the end of the way: -1 - outlet, or the
  /// texel itself, if it is a hollow or, unless the way leads `over_walls`, a wall. After
  /// bare_texels.
  int32_t next_down(int32_t texel, bool over_walls = false) const;

  /// Whether the last run changed heights.
  bool has_changed() const { return has_changed_; }
  /// Number of rounds that its blocks took together.
  double rounds() const { return rounds_; }

 private:
  struct BlockRect {
    size_t place = 0;
    glm::ivec2 size{0};
  };
  /// A link across a seam.
  struct Flow {
    float limit = 0.0f;
    float rate = 0.0f;
    float flow = 0.0f;
    /// Whether it is in listed_.
    bool is_listed = false;
  };
  /// Result of writing a block: units that left the surface (fell over rims, onto walls or off
  /// them), and whether heights changed.
  struct Written {
    double lost = 0.0;
    bool has_changed = false;
    /// From walls.
    std::vector<Release> releases;
  };
  using Blocks = std::vector<int32_t>;
  /// One flag per block of the map.
  using Marks = std::vector<uint8_t>;

  /// Calls work(i) for i from 0 to count - 1.
  template <typename Work>
  void for_each(size_t count, const Work& work) const {
    // Waking another thread takes about as long as a few rounds of a block.
    constexpr size_t kFew = 3;
    base::for_each_item(count, 1, work,
                        on_all_cores_ && count > kFew ? base::default_threads() : 1);
  }
  template <typename Work>
  void for_blocks(const Blocks& blocks, const Work& work) const {
    for_each(blocks.size(), [&](size_t i) { work(blocks[i]); });
  }
  Blocks near(const Blocks& blocks) const;
  void mark_near(int32_t block, Marks& marks) const;
  void mark_around(int32_t block, uint32_t around, Marks& marks) const;

  // setup.cpp
  void find_links();
  void update_pose();
  BlockRect rect_of(int32_t block) const;
  float highest_in(int32_t block, const std::vector<float>& height) const;
  bool rests(int32_t block, const std::vector<float>& height);
  bool begin_choice(const std::vector<float>& height, const ReposeLimits& limits);
  const BlockSlack& slack_of(int32_t block);
  void reuse_tiles(Marks& changes);
  bool cover_tile(int32_t block, const std::vector<float>& height);
  void set_up_ends(int32_t block);
  void link_walls(int32_t block);
  template <typename Visit>
  void for_linked(const TilesAround& around, int32_t column, int32_t row, const Visit& visit) const;
  Outlet wall_outlet(const RimLink& rim) const;
  bool fill_rooms(int32_t block);
  bool clear_rooms(int32_t block);
  float room_above(int32_t texel, size_t cell, ReposeTile& tile);
  glm::dvec3 point_on(const ReposeLinks::Point& at, const std::vector<glm::vec3>& positions) const;
  glm::dvec3 world_point(const ReposeLinks::Point& at) const {
    return point_on(at, object_->positions);
  }
  glm::dvec3 world_point(int32_t texel) const;
  struct Cell;
  RimLink rim_link(const Cell& a, const ReposeLinks::End& end, const glm::vec3& at) const;
  Cell across_end(int32_t link, size_t end) const;
  static Cell cell_at(const TilesAround& around, int32_t column, int32_t row);
  float link_limit(const Cell& a, const glm::vec3& at, float curvature, float steep,
                   float leads_down) const;
  float link_limit(const Cell& a, const Cell& b, float leads_down) const;

  // across.cpp
  template <typename Visit>
  void for_across(int32_t block, const Visit& visit);
  bool lower_across(Marks& active);
  void note_active(int32_t block);
  bool runs(int32_t block, int round) const;
  void list_active_links();
  bool flow_along(int32_t number, float momentum);
  bool flow_across(float momentum);

  // releases.cpp
  void collect_releases(const std::vector<Written>& written);
  /// Where ways over cells end, each cell looked at once in a run, and the units that have gone
  /// each way.
  struct CellWays {
    struct Block {
      /// The run for which it was filled.
      uint64_t run = 0;
      std::array<int32_t, kTileCells> end;
      std::array<double, kTileCells> units;
    };
    uint64_t run = 0;
    std::vector<std::unique_ptr<Block>> blocks;
    std::vector<int32_t> passed;
    /// Cells to which units have gone.
    std::vector<int32_t> ends;

    void begin(size_t count);
    Block& block_of(int32_t cell);
    int32_t find(const Repose& repose, int32_t cell);
    void add(int32_t end, double units);
  };
  int32_t next_cell(int32_t cell) const;
  int32_t cell_of_wall(const RimLink& rim) const;

  // repose.cpp
  template <typename Chosen>
  Blocks blocks_of_colour(int32_t colour, const Chosen& chosen) const;
  void link_tile(int32_t block);
  void raise_limits(int32_t block);
  float stands(int32_t a, int32_t b) const;
  void empty_over_outlets();
  void run_rounds(float work_factor);
  double run_colour(const Blocks& blocks, int first_round, int rounds_at_once);
  Written write_block(int32_t block, float walls_keep, std::vector<float>& height) const;

  const std::shared_ptr<const TexelTable>& shared_table() const {
    return coarse_ != nullptr ? coarse_ : object_->table;
  }

  const SceneObject* object_;
  const std::shared_ptr<const TexelTable> coarse_;
  ReposeLinkTables* link_tables_;
  const SceneRays* rays_;
  /// Shared with copies of the object; null before the first pose.
  std::shared_ptr<const ReposeLinks> links_;
  ReposePose pose_;
  /// Rays against pose_.positions().
  ObjectRays own_rays_;
  ReposeSurface surface_;
  bool has_pose_ = false;
  bool on_all_cores_ = false;
  bool has_changed_ = false;
  double rounds_ = 0.0;
  const std::vector<float>* stand_ = nullptr;
  /// By block: whether `stand_` has changed; empty: nowhere.
  Marks restands_;
  /// Whether snow may flow across seams.
  bool seams_are_pending_ = false;
  ReposeLimits limits_;
  /// By block, in the current pose, as far as it was needed.
  std::vector<std::optional<BlockSlack>> slack_;
  /// By block: the highest snow on it at the start of the step, in metres.
  std::vector<float> highest_;
  /// Blocks in which snow may not rest, with their neighbours.
  Blocks chosen_;
  /// By block: whether a blade has pushed snow there; empty: nowhere. And whether only those run.
  Marks blades_;
  bool is_partial_ = false;
  /// Tiles of the chosen blocks during a run (all existing ones during a partial run); all existing
  /// tiles between runs.
  ReposeTiles tiles_;
  ReposeTiles stored_tiles_;
  /// By block, in the run before.
  Marks was_chosen_;
  /// By block.
  std::vector<std::vector<RimLink>> rims_;
  std::vector<Release> releases_;
  CellWays ways_;
  bool has_bare_ = false;
  BareTexels bare_;
  /// By texel, in the current pose: the last texel of its way, and -1 - its outlet, or the last
  /// texel again; kNoWay if not known.
  std::vector<int32_t> way_last_, way_end_;
  /// By link across a seam.
  std::vector<Flow> across_;
  /// Links across seams to evaluate; between rounds, those along which snow flows.
  std::vector<int32_t> listed_;
  /// Blocks whose surfaces at seams may have changed since the last round across seams.
  Blocks noted_;
  Marks is_noted_;
};

}  // namespace snowbough::snow
