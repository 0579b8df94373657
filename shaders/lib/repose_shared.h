#pragma once

// Data of the GL engine's repose passes, declared once for C++ and GLSL. Maps are divided into blocks; only blocks with
// texels exist. A cell is a texel of a block, row by row.
#include "snow_shared.h"

#ifndef SNOWBOUGH_GLSL
namespace snowbough::shared {
#endif

/// Edge of a block in texels; and of the window in which a work group moves its snow: the block in the middle and a
/// border. In a round a cell depends on cells up to two away, so after kReposeRounds rounds the middle is still correct.
const int kReposeBlockBits = 4;
const int kReposeBlock = 1 << kReposeBlockBits;
const int kReposeCells = kReposeBlock * kReposeBlock;
const int kReposeBorder = 8;
const int kReposeWindow = kReposeBlock + 2 * kReposeBorder;
const int kReposeWindowCells = kReposeWindow * kReposeWindow;
const int kReposeRounds = kReposeBorder / 2;
/// Maximum number of iterations of bounds per dispatch.
const int kReposeBoundIterations = 24;
/// Work groups in y of a dispatch over a list of blocks: OpenGL promises 65,535 in x.
const uint kReposeListRows = 64u;

/// Kinds of an end in this step: an open link across a seam, or an outlet, a rim or wall over which snow falls.
const float kEndAtSeam = 1.0f;
const float kEndAtOutlet = 2.0f;

/// Header of a list of blocks: arguments of an indirect dispatch of kReposeListRows work groups per column, and the
/// number of blocks.
struct ReposeList {
  uint groups_x;
  uint groups_y;
  uint groups_z;
  uint count;
};
SNOWBOUGH_SHARED_SIZE(ReposeList, 16)

/// A receiver in the passes.
struct ReposeObject {
  /// xyz: a point near its middle, subtracted first; w: volume in m3 of the unit in which snow moves, a power of two.
  vec4 anchor;
  /// Place of its table of blocks, row by row: the number of each, kNowhere for one without texels; its width.
  uint table;
  uint blocks_a_side;
  /// Whether it has moved since the step before.
  uint has_moved;
  /// Number of its first block.
  uint first_block;
};
SNOWBOUGH_SHARED_SIZE(ReposeObject, 32)

/// A block's first texel, with the map's layer in its group, and its object's slot.
struct ReposeBlock {
  uint column;
  uint row;
  uint layer;
  uint slot;
};
SNOWBOUGH_SHARED_SIZE(ReposeBlock, 16)

/// Numbers of the last sweeps and steps in which a block was listed, see ReposePass.
struct ReposeBlockState {
  uint listed;
  uint listed_first;
  uint touched;
  uint unused_row_end;
};
SNOWBOUGH_SHARED_SIZE(ReposeBlockState, 16)

/// One end of a link across a seam or over a rim, at a cell.
struct ReposeEnd {
  uint cell;
  /// The cell at the other end, kNowhere at a rim.
  uint other;
  /// The point of the seam or rim: a triangle of the scene, and the weights of its second and third corner.
  uint triangle;
  float weight_b;
  float weight_c;
  /// Part of a cell's snow that may leave it in a round: 1 / number of links, of its own and of the other.
  float part;
  float other_part;
  uint unused_row_end;
};
SNOWBOUGH_SHARED_SIZE(ReposeEnd, 32)

#ifndef SNOWBOUGH_GLSL
}  // namespace snowbough::shared
#endif
