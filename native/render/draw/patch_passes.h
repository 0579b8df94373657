#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/draw/draw_kind.h"
#include "render/draw/patch_lists.h"

namespace snowbough::render {

/// An object drawn as patches. It provides the inputs of its shaders, except the view and the list.
class PatchSource {
 public:
  /// @param patches number of patches.
  explicit PatchSource(size_t patches) : camera(patches), sun(patches) {}
  virtual ~PatchSource() = default;
  PatchSource(const PatchSource&) = delete;
  PatchSource& operator=(const PatchSource&) = delete;

  /// Shader defines in addition to those of the kind.
  virtual std::vector<std::string> defines(DrawKind kind) const = 0;
  virtual void bind_classify(gpu::Program& program) const = 0;
  virtual void bind_plain(gpu::Program& program, DrawKind kind) const = 0;
  virtual void bind_tessellated(gpu::Program& program, DrawKind kind) const = 0;

  /// The patches drawn in the camera's picture and in the shadow map.
  PatchList camera;
  PatchList sun;
};

/// Classifies patches, draws the plain ones as triangles and the others through the tessellator. It
/// reads nothing back. GPU thread.
class PatchPasses {
 public:
  /// Loads the shaders <name>_classify, <name>_plain (.vert, .frag) and <name> (.vert, .tesc,
  /// .tese, .frag). `plain_vertices`: vertices per plain patch.
  PatchPasses(const std::string& name, int32_t plain_vertices);

  /// Sorts patches into dropped, plain and tessellated ones, and writes one of the source's lists
  /// with its draw commands. `max_level`: highest tessellation level of an edge in this view.
  void classify(const PatchSource& of, PatchList& list, const gpu::Buffer& view, float max_level);
  /// Draw the plain and the tessellated patches of a list into the bound framebuffer. With kCapture
  /// they write to the buffer bound to transform feedback.
  void draw_plain(const PatchSource& of, const PatchList& list, const gpu::Buffer& view,
                  const DrawStyle& style);
  void draw_tessellated(const PatchSource& of, const PatchList& list, const gpu::Buffer& view,
                        const DrawStyle& style);
  PatchCounts count(const PatchList& list) const;

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
