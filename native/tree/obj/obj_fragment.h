#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "tree/obj/obj_scene.h"

namespace snowbough::tree {

/// What an index of a face corner points to.
enum class ObjIndex : int8_t { kVertex, kUv, kNormal };

/// A negative index: it counts back from where it stands, a place that the fragment does not know.
struct RelativeIndex {
  ObjIndex kind = ObjIndex::kVertex;
  /// Corner of the fragment that it belongs to; -1 = of a normal or of a face that was left out.
  int32_t corner = -1;
  int64_t line = 0;
  /// As the file has it, and how many of the kind the fragment had brought before.
  int64_t value = 0;
  int64_t count = 0;
};

/// A positive index that pointed past all that was known when it was met; judged at the end.
struct ForwardIndex {
  int64_t index = 0;
  int64_t line = 0;
};

/// How many vertices, texture coordinates and normals stand before a place in the file; one number
/// an ObjIndex.
struct ObjCounts {
  std::array<int64_t, 3> of{};
};

/// What stands in some whole lines of an OBJ, read without knowing those before. Lines count from 0
/// at its beginning.
struct ObjFragment {
  /// A name that is as it was before the fragment, in its runs and in `last`.
  static constexpr int32_t kInherited = -2;

  /// All but the relative indices as in the whole; names and materials numbered within the
  /// fragment. corner_uv is empty when no face of the fragment has texture coordinates.
  ObjScene scene;
  /// Names in force at the end.
  FaceRun last{0, kInherited, kInherited, kInherited};
  int64_t normal_count = 0;
  int64_t line_count = 0;
  std::vector<RelativeIndex> relative;
  /// By ObjIndex, each larger than the one before.
  std::array<std::vector<ForwardIndex>, 3> forward;
  /// The first line that cannot be read and why; what follows it was left unread. Empty = all good.
  std::string error;
  int64_t error_line = 0;
};

/// Reads the lines of [begin, end); only the last may lack its line break. The text is changed:
/// continued lines are joined in place.
/// @param known  what at least stands before the fragment, which spares remembering most indices.
/// @param origin  taken off every vertex before it is rounded to single precision.
ObjFragment read_obj_fragment(char* begin, char* end, const ObjCounts& known,
                              const glm::dvec3& origin = glm::dvec3(0.0));

}  // namespace snowbough::tree
