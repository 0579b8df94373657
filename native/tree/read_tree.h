#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "base/progress.h"
#include "tree/obj/obj_scene.h"
#include "tree/skeleton/simplify.h"
#include "tree/skeleton/skeleton.h"

namespace snowbough::tree {

enum class UpAxis { kAuto, kY, kZ };

struct ReadTreeOptions {
  UpAxis up_axis = UpAxis::kAuto;
  /// Level names from the trunk on, separated by commas ("trunk,branch,limb"): a group belongs to
  /// the level whose name it starts with (the longest match wins). Empty: derived from the group
  /// names.
  std::string levels = {};
  Simplify simplify = Simplify::kNone;
  /// For kTolerance: maximum deviation of a limb from the original, in local radii.
  float tolerance = 0.5f;
  /// Keep the wood's own polygons in Skeleton::kept.
  bool keep_surface = false;
  /// Path of SpeedTree's raw XML of the same tree: its bones are the skeleton, instead of one
  /// traced along the polygons. Needs keep_surface.
  std::string bones = {};
  /// Keep leaves, needles and flowers in Skeleton::foliage.
  bool foliage = true;
  /// Name prefixes separated by commas: exactly the parts whose group, object or material starts
  /// with one of them are foliage. Empty: recognised by words in names and by shape.
  std::string foliage_names = {};
  /// Whether to read material libraries and textures outside the file's folder and its parent
  /// folder.
  bool outside_files = false;
  /// Length of one unit of the file in metres.
  double unit = 1.0;
  /// Height of the wood in metres; 0 keeps the height that `unit` gives.
  double height = 0.0;
  /// Bytes of the file read at a time.
  size_t buffer_size = size_t{4} << 20;
  /// Threads that may share the work, the calling one included; 0 = one per core. Does not change
  /// the skeleton.
  int threads = 0;
  base::Progress progress = {};
};

/// Reads a tree that Xfrog or a similar modeller exported as Wavefront OBJ: recognises its form,
/// traces the branches, connects them and collects the foliage. The result is Z up, in metres;
/// `wood` has the tubes' own polygons.
/// @throws std::invalid_argument with file and line for malformed content; with the file and advice
/// for one that has no branches or is no tree, such as a bench.
/// @throws Cancelled when progress says stop.
Skeleton read_tree(const std::string& path, const ReadTreeOptions& options = {});

/// The same for polygons that are already in memory. Materials keep only their names.
/// @param scene  as from an OBJ file, with valid indices; `positions` are replaced.
/// @param positions  of the vertices, in the scene's space.
/// @param name  of the source in messages.
/// @throws as above.
Skeleton read_tree(ObjScene scene, const std::vector<glm::dvec3>& positions,
                   const std::string& name, const ReadTreeOptions& options = {});

}  // namespace snowbough::tree
