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
#include "gpu/thread_texture.h"
#include "gpu/timer.h"
#include "render/frame_queue.h"
#include "render/sources.h"
#include "render/view.h"

namespace snowbough::render {

class Scene;

/// How a tree's bark looks.
struct TreeLook {
  /// How far it rises and falls, as a share of the limb's radius, 0 to 1.
  float bark_depth = 0.06f;
  /// Linear colours of furrows and ridges.
  glm::vec3 bark_dark{0.045f, 0.03f, 0.02f};
  glm::vec3 bark_light{0.24f, 0.18f, 0.13f};
};

/// Pixels of a picture: height x width x 4 (sRGB, alpha 1 where something was drawn), row 0 at the
/// bottom.
struct Picture {
  int32_t width = 0;
  int32_t height = 0;
  std::vector<uint8_t> rgba;
};

/// Linear light, height x width x 4, row 0 at the bottom; alpha is the share of a pixel in which
/// something was drawn, and elsewhere there is the background's light.
struct LightPicture {
  int32_t width = 0;
  int32_t height = 0;
  std::vector<float> rgba;
};

/// What OpenGL's depth buffer holds: height x width, 0 at the camera's near plane, 1 at its far one
/// and where nothing was drawn; row 0 at the bottom.
struct DepthPicture {
  int32_t width = 0;
  int32_t height = 0;
  std::vector<float> depth;
};

/// Of the last picture.
struct FrameStatistics {
  /// Patches of all trees by class.
  int64_t dropped = 0;
  int64_t plain = 0;
  int64_t tessellated = 0;
  /// Triangles handed to the rasteriser for the camera's picture, the sun's not counted.
  int64_t triangles = 0;
  /// In the order of a frame.
  std::vector<gpu::PassTime> passes;
  /// From the call to the picture, its reading back included.
  double wall_seconds = 0.0;
};

/// A tree's tessellation in the last picture, by quad of its source.
struct TreeLevels {
  /// shared::kDropped, kPlain or kTessellated.
  std::vector<uint32_t> classes;
  /// Level of the edge from each corner to the next.
  std::vector<std::array<float, 4>> edges;
};

/// Draws trees and snow off-screen with tessellation shaders, on a GPU thread of its process;
/// OpenGL 4.5, on software renderers slowly. Same input, same driver: bit-identical pictures.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, sections 3.4
/// and 4.2.2.
class Renderer {
 public:
  /// `device` as GpuThread's. @throws std::runtime_error where no context can be made.
  ///
  /// With `waits` off it returns before there is a context, and so do all functions that change
  /// what is drawn before that is done; what goes wrong on the way, the missing context included,
  /// is thrown by `take_frame`. All else waits for its answer, and for what was handed in before.
  explicit Renderer(const std::string& device = "", bool waits = true);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // All: @throws std::invalid_argument for names that are not there (or are, when adding) and for
  // bad input; std::runtime_error when closed, and for the GPU's own errors.

  void add_tree(const std::string& name, const TreeSource& source, const TreeLook& look = {});
  /// Leaves of a tree, which move with its bones; replaces those that it has.
  void set_leaves(const std::string& tree, const LeafSource& leaves);
  /// What a tree's bark shows in place of its look's colours; its relief stays.
  void set_bark(const std::string& tree, const BarkSource& bark);
  /// A matrix a bone from the rest pose to the pose; the only upload of a frame.
  void set_pose(const std::string& tree, const std::vector<glm::mat4>& matrices);
  void add_mesh(const std::string& name, const MeshSource& source);
  /// Where a mesh is: a matrix a place, from its own space to the world; at first the identity.
  void set_places(const std::string& mesh, const std::vector<glm::mat4>& matrices);
  /// Lets snow lie on a mesh; without heights: none.
  void set_mesh_snow(const std::string& mesh, const MeshSnow& snow);
  /// The snow on a tree that has places for it.
  void set_snow(const std::string& tree, const TreeSnow& snow);
  /// The same from a texture (R32F, linear filtering) where it lies, if that is in this renderer's
  /// context: whether it is. To be called again when its content has changed.
  bool share_snow(const std::string& tree, const gpu::ThreadTexture& heights,
                  const SnowDepths& depths);
  /// Takes a tree or a mesh away.
  void remove(const std::string& name);

  Picture render(const Camera& camera, const RenderSettings& settings);
  /// Means of `samples` pictures (1 to 4096), shifted within a pixel's filter.
  LightPicture render_light(const Camera& camera, const RenderSettings& settings, int32_t samples);

  /// How far away what is seen is, a sample in the middle of each pixel.
  DepthPicture render_depth(const Camera& camera, const RenderSettings& settings);

  /// Asks for a picture and waits for nothing; one that was asked for before and is not begun is
  /// forgotten. Returns its ticket.
  uint64_t request_frame(const Camera& camera, const RenderSettings& settings);
  /// The newest picture that has arrived since the last call, if any. Waits for nothing; a picture
  /// arrives only while this is called from time to time.
  std::optional<PackedFrame> take_frame();
  /// Whether a picture that was asked for has not arrived yet.
  bool is_busy() const;
  /// Whether the context is made, or could not be: `info` does not wait then.
  bool is_ready() const;

  /// @throws std::runtime_error before the first picture.
  FrameStatistics statistics() const;

  /// World positions of the triangles of a tree as the camera would see them, three a triangle, the
  /// plain patches first; what the camera does not see is left out.
  std::vector<glm::vec3> triangles(const std::string& name, const Camera& camera,
                                   const RenderSettings& settings);
  TreeLevels levels(const std::string& tree) const;

  /// The driver.
  const gpu::GpuInfo& info() const;
  /// Frees the GPU's memory; calls after it throw.
  void close();

 private:
  /// What lives on the GPU thread.
  struct Drawing;

  Drawing& drawing() const;
  /// Has `work` done with the scene; `waits_` says whether it is over when this returns.
  void change(std::function<void(Scene&)> work);
  void post_pump();

  bool waits_ = true;
  std::shared_ptr<gpu::GpuThread> thread_;
  std::unique_ptr<Drawing> drawing_;
  mutable FrameQueue queue_;
};

}  // namespace snowbough::render
