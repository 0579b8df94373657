#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <istream>
#include <string>

#include "base/progress.h"
#include "tree/obj/obj_scene.h"

namespace snowbough::tree {

struct ObjReadOptions {
  /// Bytes read at a time, of which the threads take pieces while the next are read. Grows by
  /// itself when a line is longer.
  size_t buffer_size = size_t{4} << 20;
  /// Bytes the stream holds, for the progress; 0 = unknown.
  size_t total_size = 0;
  base::Progress progress = {};
  /// Threads that share the work, the calling one included; 0 = one a core. The scene and the
  /// errors do not depend on it.
  int threads = 0;
  /// Taken off every vertex before it is rounded to single precision.
  glm::dvec3 origin{0.0};
};

/// Reads a Wavefront OBJ in one pass through two small buffers; the text is never held as a whole.
///
/// Takes what real files hold: double and trailing blanks, tabs, LF, CRLF or CR, line continuation
/// by
/// `\`, bare `g`, names with blanks, `v`, `v/vt`, `v//vn` and `v/vt/vn`, negative (relative) and
/// forward indices, exponents, a leading `+`, vertex colours, a byte order mark, unknown keywords.
///
/// @param name what errors call the source, usually the file's path.
/// @throws std::invalid_argument "<name>:<line>: ..." for malformed or non-finite numbers and for
///   indices that are malformed, zero or out of range; "<name>: ..." for a source that holds no
///   vertices or no faces.
/// @throws Cancelled when progress says stop.
///
/// Format: Wavefront, "Advanced Visualizer Manual", appendix B1, "Object Files (.obj)".
ObjScene read_obj(std::istream& stream, const std::string& name,
                  const ObjReadOptions& options = {});

/// The same for a file. @throws std::invalid_argument when it cannot be opened.
ObjScene read_obj_file(const std::string& path, ObjReadOptions options = {});

}  // namespace snowbough::tree
