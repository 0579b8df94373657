#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <istream>
#include <string>

#include "base/progress.h"
#include "tree/obj/obj_scene.h"

namespace snowbough::tree {

struct ObjReadOptions {
  /// Bytes read at a time; threads parse parts of them while the next are read. Grows for longer
  /// lines.
  size_t buffer_size = size_t{4} << 20;
  /// Size of the stream in bytes, for the progress; 0 = unknown.
  size_t total_size = 0;
  base::Progress progress = {};
  /// Threads that share the work, the calling one included; 0 = one per core. Does not change the
  /// scene or the errors.
  int threads = 0;
  /// Subtracted from every vertex before rounding to single precision.
  glm::dvec3 origin{0.0};
};

/// Reads a Wavefront OBJ in one pass through two small buffers; the text is never held as a whole.
///
/// Accepts repeated and trailing blanks, tabs, LF, CRLF or CR, line continuation by `\`, bare `g`,
/// names with blanks, `v`, `v/vt`, `v//vn` and `v/vt/vn`, negative (relative) and forward indices,
/// exponents, a leading `+`, vertex colours, a byte order mark, and unknown keywords.
///
/// @param name name of the source in errors, usually the file's path.
/// @throws std::invalid_argument "<name>:<line>: ..." for malformed or non-finite numbers and for
/// indices that are malformed, zero or out of range; "<name>: ..." for a source without vertices or
/// faces.
/// @throws Cancelled when progress says stop.
///
/// Format: Wavefront, "Advanced Visualizer Manual", appendix B1, "Object Files (.obj)".
ObjScene read_obj(std::istream& stream, const std::string& name,
                  const ObjReadOptions& options = {});

/// The same for a file. @throws std::invalid_argument if it cannot be opened.
ObjScene read_obj_file(const std::string& path, ObjReadOptions options = {});

}  // namespace snowbough::tree
