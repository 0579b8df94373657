#pragma once

#include <cstdint>
#include <functional>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gpu/gpu_thread.h"
#include "gpu/program.h"
#include "gpu/thread_texture.h"
#include "gpu/timer.h"
#include "render/data/pictures.h"
#include "render/data/sources.h"
#include "render/data/view.h"
#include "render/frame_queue.h"

namespace snowbough::render {

class SceneObjects;

/// Storage blocks that a stage of the renderer's shaders uses at most, see gpu::storage_blocks.
inline constexpr int32_t kStorageBlocks = 13;

/// Draws trees and snow off-screen with tessellation shaders, on its own GPU thread. It needs
/// OpenGL 4.5 and is slow on software renderers. The same input on the same driver gives
/// bit-identical pictures.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, sections 3.4 and 4.2.2.
class Renderer {
 public:
  /// `device` as for GpuThread. @throws std::runtime_error if no context can be created, or if its
  /// driver has fewer than kStorageBlocks storage blocks.
  ///
  /// With `waits` false, the constructor and all functions that change the scene return
  /// immediately, even before the context exists. `take_frame` then throws errors of these calls,
  /// including a missing context. All other functions wait for the result and for all earlier
  /// calls.
  explicit Renderer(const std::string& device = "", bool waits = true);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // All functions: @throws std::invalid_argument for unknown names (or existing ones when adding)
  // and for bad input; std::runtime_error after `close` and for GPU errors.

  void add_tree(const std::string& name, const TreeSource& source, const TreeLook& look = {});
  /// Adds a tree that shares base, bark and leaves with another one. It has its own pose, instances
  /// and snow.
  void share_tree(const std::string& name, const std::string& tree);
  /// Sets the leaves of a tree, which move with its bones, and replaces earlier ones.
  void set_leaves(const std::string& tree, const LeafSource& leaves);
  /// Sets the images of a tree's bark, which replace the look's colours; the bark's relief stays.
  void set_bark(const std::string& tree, const BarkSource& bark);
  /// Sets the pose: one matrix per bone, from the rest pose to the current pose. This is the only
  /// upload per frame.
  void set_pose(const std::string& tree, const std::vector<glm::mat4>& matrices);
  void add_mesh(const std::string& name, const MeshSource& source);
  /// Sets the instances of a mesh or a tree: a matrix for each, from its own space, or that of
  /// the pose, to the world. The default is the identity.
  void set_instances(const std::string& name, const std::vector<glm::mat4>& matrices);
  /// Sets the snow on a mesh; a map without heights removes it.
  void set_mesh_snow(const std::string& mesh, const MeshSnow& snow);
  /// Sets the snow on a tree that has snow map coordinates.
  void set_snow(const std::string& tree, const TreeSnow& snow);
  /// Sets the snow from a texture (R32F), which is copied on the GPU. Returns false if the
  /// texture is not in this renderer's context. Call it again when the texture's content has
  /// changed.
  bool share_snow(const std::string& tree, const gpu::ThreadTexture& heights, const SnowLook& look);
  /// Removes a tree or a mesh.
  void remove(const std::string& name);

  Picture render(const Camera& camera, const RenderSettings& settings);
  /// The mean of `samples` pictures (1 to 4096), each shifted within the pixel's filter.
  LightPicture render_light(const Camera& camera, const RenderSettings& settings, int32_t samples);

  /// Depth of the visible surfaces, with one sample at the centre of each pixel.
  DepthPicture render_depth(const Camera& camera, const RenderSettings& settings);

  /// Requests a picture and returns immediately with its ticket. A pending request is replaced.
  uint64_t request_frame(const Camera& camera, const RenderSettings& settings);
  /// The newest picture that has arrived since the last call, if any. It never blocks. Pictures
  /// arrive only if this is called repeatedly.
  std::optional<PackedFrame> take_frame();
  /// True while a requested picture has not arrived.
  bool is_busy() const;
  /// True once the context exists or its creation has failed; `info` does not wait then.
  bool is_ready() const;

  /// @throws std::runtime_error before the first picture.
  FrameStatistics statistics() const;

  /// World positions of a tree's triangles as tessellated for the camera, three per triangle, the
  /// plain patches first in the order of the source's quads. Patches outside the camera's view are
  /// left out.
  std::vector<glm::vec3> triangles(const std::string& name, const Camera& camera,
                                   const RenderSettings& settings);
  TreeLevels levels(const std::string& tree) const;

  /// Information about the OpenGL driver.
  const gpu::GpuInfo& info() const;
  /// Frees the GPU's memory; later calls throw.
  void close();

 private:
  /// State that lives on the GPU thread.
  struct Drawing;

  Drawing& drawing() const;
  /// Runs `work` on the scene on the GPU thread. It waits for the end only if `waits_` is true.
  void change(std::function<void(SceneObjects&)> work);
  void post_pump();

  bool waits_ = true;
  std::shared_ptr<gpu::GpuThread> thread_;
  std::unique_ptr<Drawing> drawing_;
  mutable FrameQueue queue_;
};

}  // namespace snowbough::render
