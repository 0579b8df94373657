#include "tree/mesh/limb_sections.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {

std::vector<LimbSection> limb_sections(const Surface& surface) {
  std::vector<LimbSection> sections;
  std::vector<int32_t> limb_of_vertex(surface.vertices.size(), -1);
  std::vector<uint8_t> is_child(surface.limbs.size(), 0);
  for (const Junction& junction : surface.junctions) {
    is_child[junction.child] = 1;
  }
  const double to_radius = std::sqrt(2.0 / M_PI);
  for (size_t b = 0; b < surface.limbs.size(); ++b) {
    const LimbSurface& limb = surface.limbs[b];
    const int32_t name =
        limb.continues_parent ? limb_of_vertex[limb.rings[0].vertices[0]] : static_cast<int32_t>(b);
    for (size_t row = 0; row + 1 < limb.rings.size(); ++row) {
      const Ring& a = limb.rings[row];
      const Ring& c = limb.rings[row + 1];
      LimbSection section;
      section.begin = a.centre;
      section.length = std::max(glm::distance(a.centre, c.centre), 1e-30);
      section.axis = (c.centre - a.centre) / section.length;
      section.begin_radius = a.corner * to_radius;
      section.end_radius = c.corner * to_radius;
      section.from_hole = row == 0 && name == static_cast<int32_t>(b) && is_child[b] != 0;
      sections.push_back(section);
    }
    for (int32_t v : limb.rings.back().vertices) {
      limb_of_vertex[v] = name;
    }
  }
  return sections;
}

}  // namespace snowbough::tree
