#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/surface/rims.h"
#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// Width of the zone behind a rim in which snow is drawn to the rim, in metres, if there is room.
float rim_zone(float depth);
/// Greatest distance that the underside of the hem reaches down the far face, in metres.
float far_zone(float depth);
/// Greatest width of a strip, such as a bevel, that counts as one rim, in metres.
float rim_strip(float depth);

/// Computes the rim zone of any place on a receiver.
class RimZones {
 public:
  /// `needles`: see are_needles. Hems on all of them would take too many points; cushions join
  /// their snow.
  RimZones(const SurfaceMesh& receiver, const Rims& rims, float depth, bool needles = false);

  struct Zone {
    RimPosition place;
    /// Widths available to a front behind the rim and down the far face, in metres, both over 0.
    float support = 1.0f;
    float far = 1.0f;
    /// Distance from the rim to the middle between this rim and those opposite, in metres.
    float room = 0.0f;
    /// Distance as a fraction of the zone's width; negative on the far face.
    float share = 0.0f;
  };
  /// `normal`: unit normal of the face that holds the point.
  Zone at(const glm::vec3& point, const glm::vec3& normal, int32_t part) const;
  /// Computes the zones of a refined mesh's points that `zones` does not hold yet. Of the faces at
  /// a point, the one nearest to a rim counts; on the rim itself the supporting face counts.
  void find(const SurfaceMesh& mesh, std::vector<Zone>& zones) const;
  /// The part of the receiver (face_parts) that holds a source triangle.
  int32_t part(int32_t base) const { return part_of_base_[static_cast<size_t>(base)]; }

 private:
  const Rims& rims_;
  float depth_;
  bool needles_;
  /// Indexed by source triangle.
  std::vector<int32_t> part_of_base_;
  std::vector<glm::vec3> normal_of_base_;
};

}  // namespace snowbough::snow
