#pragma once

#include <cstddef>
#include <string>

#include "base/progress.h"
#include "tree/skeleton/simplify.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

enum class UpAxis { kAuto, kY, kZ };

struct ReadTreeOptions {
  UpAxis up_axis = UpAxis::kAuto;
  /// Level names from the trunk on, separated by commas ("trunk,branch,limb"): a group belongs to
  /// the level whose name it starts with (the longest one wins). Empty: the groups tell.
  std::string levels = {};
  Simplify simplify = Simplify::kNone;
  /// For kTolerance: how far a limb may stray from the original, in its local radii.
  float tolerance = 0.5f;
  /// Keep leaves, needles and flowers in Skeleton::foliage.
  bool foliage = true;
  /// Names separated by commas: parts whose group, object or material starts with one of them are
  /// foliage and no others. Empty: told by the names' words and by shape.
  std::string foliage_names = {};
  /// Whether libraries and textures are read that lie neither below the file's folder nor below the
  /// folder above it.
  bool outside_files = false;
  /// Metres that one unit of the file is.
  double unit = 1.0;
  /// Metres that the wood shall be high, whatever its unit; 0 = as high as its unit says.
  double height = 0.0;
  /// Bytes of the file read at a time.
  size_t buffer_size = size_t{4} << 20;
  /// Threads that may share the work, the calling one included; 0 = one a core. The skeleton does
  /// not depend on it.
  int threads = 0;
  base::Progress progress = {};
};

/// Reads a tree that Xfrog or a similar modeller exported as Wavefront OBJ: finds out which of the
/// forms it has, traces the branches, connects them and gathers the foliage. The result is Z
/// up, in metres; `wood` has the tubes' own polygons.
///
/// @throws std::invalid_argument with file and line for malformed content; with the file and what
///   to do for one that holds no branches or is no tree, such as a bench.
/// @throws Cancelled when progress says stop.
Skeleton read_tree(const std::string& path, const ReadTreeOptions& options = {});

}  // namespace snowbough::tree
