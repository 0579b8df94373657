#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "snow/repose/field.h"
#include "snow/repose/links.h"
#include "snow/repose/surface.h"
#include "snow/scene/scene_object.h"

namespace snowbough::snow {

/// How steep snow's own surface may be.
struct ReposeSettings {
  /// Radians from level; from kOff on snow stays where it fell, to the bit.
  double angle = 1.5707963267948966;
  static constexpr double kOff = 1.5706;
  bool is_on() const { return angle < kOff; }
};

/// Repose on one receiver's map: snow whose surface is steeper than the angle of repose moves to
/// lower neighbours (shaders/lib/texel_repose.h, where the method stands), over seams and over rims
/// into the air, until it rests or the step's work is done; what is left moves on in the next step.
/// All that it needs to go on is in the heights.
///
/// Blocks in which nothing can be steep are left out, which their heights' range tells as long as
/// the surface stands still. The result does not depend on threads.
class Repose {
 public:
  /// `object`, which has positions, must live as long.
  explicit Repose(const SceneObject& object) : object_(&object) {}

  /// To be called when the object's positions have changed.
  void forget_pose() { has_pose_ = false; }

  /// Looks at the heights and chooses the blocks in which snow may move; returns their number.
  /// `slope`: tangent of the angle.
  size_t choose_blocks(const std::vector<float>& height, float slope);

  /// Moves snow on `height` in those blocks. `patience`: by how much longer than usual a step may
  /// go on; `on_all_cores`: shares the work among threads. Returns what fell over rims, in m3.
  double run(std::vector<float>& height, float patience, ReposeField& field, bool on_all_cores);

  /// The blocks (of the links' numbering) in which the last run changed heights.
  const std::vector<int32_t>& changed() const { return changed_; }
  const ReposeLinks& links() const { return links_; }

 private:
  /// What is known of a block's links while the surface stands still, in metres: by how much they
  /// are under their limits where it is bare, at least; the same of links over edges that do not
  /// hold; by how much normals differ across them. See is_level.
  struct BlockSlack {
    bool is_known = false;
    float inside = 0.0f;
    float at_edges = 0.0f;
    float turn = 0.0f;
  };
  struct Range {
    float low = 0.0f;
    float high = 0.0f;
  };
  using Work = std::function<void(int32_t block)>;
  void for_blocks(const std::vector<int32_t>& blocks, const Work& work) const;
  void take_pose();
  Range range_of(int32_t block, const std::vector<float>& height) const;
  bool is_level(int32_t block, const std::vector<Range>& ranges) const;
  /// The blocks near those, ascending; `only`: of those that it marks.
  std::vector<int32_t> near(const std::vector<int32_t>& blocks,
                            const std::vector<uint8_t>* only) const;
  bool set_up_block(int32_t block, ReposeField& field);
  bool set_up_link(const ReposeField& field, size_t a, size_t b, float& limit, float& rate,
                   BlockSlack& slack) const;
  bool set_up_ends(int32_t block, const ReposeField& field, BlockSlack& slack);
  void run_rounds(std::vector<int32_t> awake, float patience, ReposeField& field);
  bool flow_block(int32_t block, float momentum, ReposeField& field);
  bool move_block(int32_t block, ReposeField& field) const;
  void raise_tops(int32_t block, ReposeField& field) const;
  double write_block(int32_t block, std::vector<float>& height, const ReposeField& field) const;
  void clear_block(int32_t block, ReposeField& field) const;

  /// Rows and columns of a block, as cells.
  struct Cells {
    size_t begin;
    int32_t columns;
    int32_t rows;
  };
  Cells cells_of(int32_t block, const ReposeField& field) const;

  const SceneObject* object_;
  ReposeLinks links_;
  ReposeSurface surface_;
  bool has_pose_ = false;
  float slope_ = 0.0f;
  std::vector<BlockSlack> slack_;
  /// Blocks to look at closely, these with those near them, and per block whether it is one.
  std::vector<int32_t> doubtful_;
  std::vector<int32_t> chosen_;
  std::vector<uint8_t> is_chosen_;
  std::vector<int32_t> changed_;
  bool on_all_cores_ = false;
  /// Per link across a seam or rim, as the field's planes.
  std::vector<float> end_limit_, end_rate_, end_flow_, rim_top_;
};

}  // namespace snowbough::snow
