#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "tree/obj/obj_scene.h"

namespace snowbough::tree {

/// The kind of a face corner's index.
enum class ObjIndex : int8_t { kVertex, kUv, kNormal };

/// A negative index: it counts back from its own position, which the fragment does not know.
struct RelativeIndex {
  ObjIndex kind = ObjIndex::kVertex;
  /// Corner of the fragment; -1 for faces that were left out.
  int32_t corner = -1;
  int64_t line = 0;
  /// The value in the file, and the number of elements of this kind earlier in the fragment.
  int64_t value = 0;
  int64_t count = 0;
};

/// A positive index beyond all elements known at its position; checked at the end.
struct ForwardIndex {
  int64_t index = 0;
  int64_t line = 0;
};

/// Number of vertices, texture coordinates and normals before a position in the file, by ObjIndex.
struct ObjCounts {
  std::array<int64_t, 3> of{};
};

/// The content of some whole lines of an OBJ, parsed without the lines before. Lines count from 0.
struct ObjFragment {
  /// A name unchanged since before the fragment, in its runs and in `last`.
  static constexpr int32_t kInherited = -2;

  /// Everything except relative indices; names and materials are numbered within the fragment.
  /// corner_uv and corner_normal are empty if no face of the fragment has them.
  ObjScene scene;
  /// Names in effect at the end.
  FaceRun last{0, kInherited, kInherited, kInherited};
  int64_t line_count = 0;
  std::vector<RelativeIndex> relative;
  /// By ObjIndex, each larger than the one before.
  std::array<std::vector<ForwardIndex>, 3> forward;
  /// The first unreadable line and the reason; the rest was not read. Empty: no error.
  std::string error;
  int64_t error_line = 0;
};

/// Parses the lines of [begin, end); only the last may lack its line break. Modifies the text:
/// continued lines are joined in place.
/// @param known  lower bounds of the counts before the fragment, so that few indices need checking
///   later.
/// @param origin  subtracted from every vertex before rounding to single precision.
ObjFragment read_obj_fragment(char* begin, char* end, const ObjCounts& known,
                              const glm::dvec3& origin = glm::dvec3(0.0));

}  // namespace snowbough::tree
