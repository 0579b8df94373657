#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "snow/surface/rims.h"
#include "snow/surface/surface_mesh.h"

namespace snowbough::snow {

/// Width in metres of the zone behind a rim in which snow is drawn to it, where there is room.
float rim_zone(float depth);
/// How far down the far face the underside of the hem may reach.
float far_zone(float depth);

/// What places on a receiver know of its rims.
class RimZones {
 public:
  RimZones(const SurfaceMesh& receiver, const Rims& rims, float depth);

  struct Zone {
    RimPlace place;
    /// Metres behind the rim and down the far face that a front may take there, both over 0.
    float support = 1.0f;
    float far = 1.0f;
    /// Metres from the rim to the middle between it and those opposite.
    float room = 0.0f;
    /// Distance as a part of its zone, negative on the far face.
    float share = 0.0f;
  };
  /// `normal`: of the face that the point lies on.
  Zone at(const glm::vec3& point, const glm::vec3& normal, int32_t part) const;
  /// The zones of a refined mesh's points, each on the face of its that is nearest to a rim; on the
  /// rim itself the carrying face counts. Those that `zones` holds already are left alone.
  void find(const SurfaceMesh& mesh, std::vector<Zone>& zones) const;
  /// The connected part of the receiver that a triangle of the source belongs to.
  int32_t part(int32_t base) const { return part_of_base_[static_cast<size_t>(base)]; }

 private:
  const Rims& rims_;
  float depth_;
  /// Of the source's triangles.
  std::vector<int32_t> part_of_base_;
  std::vector<glm::vec3> normal_of_base_;
};

}  // namespace snowbough::snow
