#include "tree/read/up_axis.h"

#include <algorithm>
#include <cmath>

namespace snowbough::tree {

bool grows_along_y(const std::vector<Branch>& branches) {
  double along_y = 0.0;
  double along_z = 0.0;
  for (const Branch& branch : branches) {
    if (branch.parent >= 0) continue;
    const double thickest = *std::max_element(branch.radii.begin(), branch.radii.end());
    const glm::dvec3 rise = glm::dvec3(branch.points.back()) - glm::dvec3(branch.points.front());
    along_y += std::abs(rise.y) * thickest * thickest;
    along_z += std::abs(rise.z) * thickest * thickest;
  }
  return along_y >= along_z;
}

void turn_y_up_to_z_up(std::vector<Branch>& branches) {
  for (Branch& branch : branches) {
    branch.attach_point = y_up_to_z_up(branch.attach_point);
    for (glm::vec3& p : branch.points) p = y_up_to_z_up(p);
  }
}

}  // namespace snowbough::tree
