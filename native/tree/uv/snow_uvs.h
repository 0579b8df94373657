#pragma once

#include "base/parallel_for.h"
#include "tree/skeleton/skeleton.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// Fills mesh.uv_snow: the unique, non-overlapping layout in which snow accumulates.
///
/// Every limb, together with the children that continue it straight on, is cut along the corner
/// that faces the ground most, unrolled into a strip as wide as its perimeter, and packed into the
/// unit square, tapered strips head to tail. Laid out for a map of `snow_resolution` squared
/// texels:
/// - charts are at least two texels wide: thinner limbs are widened, and shortened by up to half so
///   that their texels per m2 stay near those of the rest, which are the same everywhere;
/// - between two charts at least one texel stays free, two where one of them is wider than four;
///   one texel stays free along the border of the map (textures repeat by default);
/// - no texel is touched by two charts, and every face has positive area, caps and insets included:
///   a cap hangs on its strip's end, insets lie in their knuckle's cell;
/// - a strip longer than the map is cut between two rows, if possible not where a child continues.
/// The scale is nearly the largest at which all charts fit: lay_out_charts finds it.
///
/// @param mesh  the level-0 mesh: quads, origins and vertices filled as FaceOrigin says. Fills
///   uv_snow, one entry a quad, and may add to warnings.
/// @param skeleton  the tree the mesh was built from: origins index its branches.
/// @param snow_resolution  side of the map in texels, 16 to 16384. A tree with more charts than
///   such a map holds is laid out for the smallest power of two that does hold them, and a warning
///   says so: an import never fails for its UVs, and the artist reads which resolution is needed.
/// @throws Cancelled when execution's progress says stop, before any UV is written.
/// @throws std::invalid_argument if snow_resolution is out of range, if the origins contradict the
///   quads (naming branch, row and side), or if the charts fit on no map up to 16384.
void layout_snow_uvs(TreeMesh& mesh, const Skeleton& skeleton, int snow_resolution,
                     const base::Execution& execution = {});

}  // namespace snowbough::tree
