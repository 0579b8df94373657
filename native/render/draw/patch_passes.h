#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/draw/draw_kind.h"
#include "render/draw/patch_lists.h"

namespace snowbough::render {

/// What trees and snow share: patches are classified, the plain ones drawn as triangles and the
/// others through the tessellator. Nothing is read back. GPU thread.
class PatchPasses {
 public:
  /// Binds what the shaders of a kind of patches read besides the view and the list.
  using Inputs = std::function<void(gpu::Program&)>;

  /// Of the shaders <name>_classify, <name>_plain (.vert, .frag) and <name> (.vert, .tesc, .tese,
  /// .frag), with `plain_vertices` a plain patch.
  PatchPasses(const std::string& name, int32_t plain_vertices);

  /// Sorts patches into dropped, plain and tessellated and writes their lists and draws.
  /// `max_level`: the highest level that an edge of the view can have.
  void classify(PatchList& list, const gpu::Buffer& view, float max_level, const Inputs& inputs);
  /// Draws a list's two parts into the bound framebuffer (kCapture: into the buffer bound to
  /// transform feedback). `defines`: besides the kind's.
  void draw_plain(const PatchList& list, const gpu::Buffer& view, const DrawStyle& style,
                  const std::vector<std::string>& defines, const Inputs& inputs);
  void draw_tessellated(const PatchList& list, const gpu::Buffer& view, const DrawStyle& style,
                        const std::vector<std::string>& defines, const Inputs& inputs);

 private:
  int32_t plain_vertices_;
  gpu::Program classify_;
  PatchListPasses lists_;
  gpu::ProgramVariants plain_;
  gpu::ProgramVariants plain_capture_;
  gpu::ProgramVariants tessellated_;
  gpu::ProgramVariants tessellated_capture_;
};

}  // namespace snowbough::render
