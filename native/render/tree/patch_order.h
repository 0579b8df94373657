#pragma once

#include "render/tree/tree_patches.h"

namespace snowbough::render {

/// Sorts a tree's patches by descending size (see DropOrder), and its vertices and edges by their
/// first use. So a distant tree needs only the beginnings of its arrays.
///
/// Source: R. Cook, J. Halstead, M. Planck, D. Ryu, Stochastic Simplification of Aggregate Detail,
/// 2007: elements are drawn in one order, as a prefix that shrinks with the distance.
void order_patches(TreePatches& tree);

}  // namespace snowbough::render
