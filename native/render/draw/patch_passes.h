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

/// What is drawn as patches, and what the shaders of its kind of patches read of it besides the
/// view and a list.
class PatchSource {
 public:
  /// Of `patches` patches.
  explicit PatchSource(size_t patches) : camera(patches), sun(patches) {}
  virtual ~PatchSource() = default;
  PatchSource(const PatchSource&) = delete;
  PatchSource& operator=(const PatchSource&) = delete;

  /// Defines of its draws' shaders, besides the kind's.
  virtual std::vector<std::string> defines(DrawKind kind) const = 0;
  virtual void bind_classify(gpu::Program& program) const = 0;
  virtual void bind_plain(gpu::Program& program, DrawKind kind) const = 0;
  virtual void bind_tessellated(gpu::Program& program, DrawKind kind) const = 0;

  /// What is drawn of it in the camera's picture and in the sun's.
  PatchList camera;
  PatchList sun;
};

/// Patches are classified, the plain ones drawn as triangles and the
/// others through the tessellator. Nothing is read back. GPU thread.
class PatchPasses {
 public:
  /// Of the shaders <name>_classify, <name>_plain (.vert, .frag) and <name> (.vert, .tesc, .tese,
  /// .frag), with `plain_vertices` a plain patch.
  PatchPasses(const std::string& name, int32_t plain_vertices);

  /// Sorts patches into dropped, plain and tessellated and writes one of the source's lists and its
  /// draws. `max_level`: the highest level that an edge of the view can have.
  void classify(const PatchSource& of, PatchList& list, const gpu::Buffer& view, float max_level);
  /// Draws a list's two parts into the bound framebuffer (kCapture: into the buffer bound to
  /// transform feedback).
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
