#pragma once

#include "base/parallel_for.h"
#include "tree/skeleton/skeleton.h"
#include "tree/skeleton/tree_mesh.h"

namespace snowbough::tree {

/// Fills mesh.uv_snow: the unique, non-overlapping layout of the snow maps.
///
/// Every limb, together with the children that continue it straight on, is cut along the corner
/// that faces the ground most, unrolled into a strip as wide as its perimeter, and packed into the
/// unit square, tapered strips head to tail, for a map of `snow_resolution` squared texels:
/// - charts are at least two texels wide: thinner limbs are widened, and shortened to a tenth at
///   most, so that their texels per m2 stay near those of the rest, which are uniform;
/// - between two charts at least one texel is free, two if one of them is wider than four; one
///   texel is free along the border of the map (textures repeat by default);
/// - no texel is touched by two charts, and every face has positive area, including caps and
///   insets: a cap is at its strip's end, insets are in their knuckle's cell;
/// - a strip longer than the map is cut between two rows, if possible not where a child continues.
/// The scale is nearly the largest at which all charts fit: see lay_out_charts.
///
/// @param mesh  the base mesh with quads, origins and vertices as in FaceOrigin. Fills uv_snow,
///   one entry per quad, and may add to warnings.
/// @param skeleton  the tree from which the mesh was built: origins index its branches.
/// @param snow_resolution  side of the map in texels, 16 to 16384. If the charts do not fit, the
///   layout is made for the smallest power of two at which they do, and a warning names it: an
///   import never fails because of its UVs.
/// @throws Cancelled when execution's progress says stop, before any UV is written.
/// @throws std::invalid_argument if snow_resolution is out of range, if the origins contradict the
/// quads (naming branch, row and side), or if the charts do not fit a map of 16384.
void layout_snow_uvs(TreeMesh& mesh, const Skeleton& skeleton, int snow_resolution,
                     const base::Execution& execution = {});

}  // namespace snowbough::tree
