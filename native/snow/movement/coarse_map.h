#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "snow/movement/moving_map.h"
#include "snow/movement/rays/scene_rays.h"
#include "snow/movement/repose/repose.h"
#include "snow/movement/repose/surface.h"
#include "snow/texels/coarse_texels.h"

namespace snowbough::snow {

/// A coarser map of a receiver on which its snow comes to rest: fewer texels, and fewer rounds
/// across them. Where snow has moved, the receiver's own map then follows: each square keeps its
/// volume, and slopes as its neighbours show.
class CoarseMap {
 public:
  /// `side`: of the squares of texels that become one, a power of two. Null if the map cannot be
  /// coarser: see join_texels. Arguments as for Repose.
  static std::unique_ptr<CoarseMap> make(const SceneObject& object, int32_t side,
                                         ReposeLinkTables& tables, const SceneRays& rays);

  Repose& repose() { return repose_; }
  void forget_pose();

  /// Lets no snow pass the squares of these texels, until the next call.
  void block(const std::vector<int32_t>& texels);
  /// By block of the receiver's map: the squares' block in which it lies.
  std::vector<int32_t> blocks_of_own() const;

  /// The blocks in which, or beside which, a step has released snow, ascending.
  std::vector<int32_t> blocks_with_released(const MovingMap& map);
  /// The map of the squares' mean heights, until `end` is called. `blocks`: ascending, where and
  /// beside where snow moves; null: all.
  MovingMap begin(const MovingMap& map, const std::vector<int32_t>* blocks = nullptr);
  /// Takes back what `moved` has become.
  void end(const MovingMap& moved, MovingMap& map);

 private:
  CoarseMap(const SceneObject& object, CoarseTexels texels, std::unique_ptr<const TexelTable> table,
            ReposeLinkTables& tables, const SceneRays& rays);
  void update_areas();
  template <typename Visit>
  void for_squares(const Visit& visit) const;
  void join_square(size_t square, const std::vector<float>& height);
  /// A square's slope to the right and upwards, in metres of thickness per square.
  glm::vec2 slope_at(int32_t place) const;
  struct Part;
  bool spread(size_t square, std::vector<float>& height, std::vector<Part>& parts) const;
  static double fill_height(const std::vector<Part>& parts, double volume);

  const SceneObject* object_;
  /// Its table is repose_'s.
  CoarseTexels texels_;
  Repose repose_;
  bool has_areas_ = false;
  /// Per texel of the receiver's map: area in m2; upward part of the normal of the faces on which
  /// snow can lie; and the same times their part of the area, as in TileGround.
  std::vector<float> area_, up_, normal_z_;
  /// Per square: area in m2.
  std::vector<double> square_area_;
  /// By place on the coarse map: upward part of the mean normal.
  std::vector<float> square_up_;
  /// By place on the coarse map: metres, and before the last movement.
  std::vector<float> height_, before_;
  /// What `begin` has been given.
  std::optional<std::vector<int32_t>> blocks_;
  /// By coarse texel: a place on the receiver's map.
  std::vector<int32_t> places_;
  /// By place on the coarse map: the height to which snow stands; and the places of those over 0.
  std::vector<float> stand_;
  std::vector<int32_t> blocked_;
};

/// The coarser maps of a scene's receivers. The surface of snow has no detail that is much smaller
/// than its depth, so that texels need not be smaller than max(2 mm, depth / 24) where it comes to
/// rest: squares of 2 x 2, 4 x 4, ... texels are joined to about this size. Gain: a frame of two
/// steps of a monkey's map of 2048 under 11 cm takes 0.38 s of the processor instead of 0.64 s; the
/// snow differs by 0.13 mm on average, and by less than 2 mm on 99 % of it.
///
/// The choice depends on the pose at rest and on the heights alone, so that a resumed bake makes it
/// too. Masks keep the receiver's own map, and so does the snow near packed snow.
class CoarseMaps {
 public:
  /// `objects` and `rays` must live until the next call.
  void lay_out(const std::vector<const SceneObject*>& objects, const SceneRays& rays);
  void forget_pose(size_t object);
  void forget_rooms(size_t object);
  /// The coarser map on which a receiver's snow moves now, or null: its own, `own`. Replaces it if
  /// its texels have another size now. `of_grains`: see ReposeSettings::is_granular.
  /// Until `begin_step` the choice stays.
  CoarseMap* choose(const MovingMap& map, bool of_grains, ReposeLinkTables& tables, Repose& own);
  void begin_step() { is_chosen_.assign(objects_.size(), 0); }

 private:
  struct Level {
    /// Longer and shorter side of a texel in metres, on average; 0: not known yet.
    glm::dvec2 texel_size{0.0};
    /// Texels a side of its squares, if they can be joined.
    int32_t wanted = 1;
    std::unique_ptr<CoarseMap> map;
  };
  std::vector<const SceneObject*> objects_;
  const SceneRays* rays_ = nullptr;
  std::vector<Level> levels_;
  std::vector<uint8_t> is_chosen_;
};

}  // namespace snowbough::snow
