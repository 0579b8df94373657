#pragma once

#include <cstdint>
#include <vector>

#include "native/tree/built_surface.h"
#include "tree/collars/fork_field.h"
#include "tree/mesh/edges.h"
#include "tree/tubes/cuts.h"
#include "tree/tubes/limb_shape.h"
#include "tree/tubes/limb_tubes.h"

namespace snowbough::tree {

/// A skeleton's limbs as round tubes at Film, and its forks.
struct BuiltTubes {
  Built built;
  BaseCuts cuts;
  LimbTubes tubes;
  std::vector<Fork> forks;

  explicit BuiltTubes(const Skeleton& skeleton)
      : BuiltTubes(build(skeleton), parents_of(skeleton)) {}

 private:
  BuiltTubes(Built surface, const std::vector<int32_t>& parents)
      : BuiltTubes(
            surface, parents,
            limb_shapes(surface.surface, surface.paths, parents, 5e-4 * surface.scale.height)) {}

  BuiltTubes(const Built& surface, const std::vector<int32_t>& parents,
             const std::vector<LimbShape>& shapes)
      : built(surface),
        cuts(cut_base(built.surface, Edges(built.surface.quads, built.surface.vertices.size()),
                      shapes, built.scale.height, detail_settings(Detail::kFilm))),
        tubes(built.surface, shapes, cuts, limb_chains(built.surface, parents)),
        forks(collect_forks(built.surface, tubes)) {}

  static std::vector<int32_t> parents_of(const Skeleton& skeleton) {
    std::vector<int32_t> parents;
    for (const Branch& branch : skeleton.branches) parents.push_back(branch.parent);
    return parents;
  }
};

}  // namespace snowbough::tree
