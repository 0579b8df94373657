#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "gpu/gpu_thread.h"
#include "gpu/thread_texture.h"
#include "gpu/timer.h"
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

/// Of the last picture.
struct FrameStatistics {
  /// Patches of all trees and meshes with snow by class.
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

/// The tessellation of a mesh with snow in the last picture, by patch: a triangle of the mesh, or a
/// part of one that covers many texels.
struct SnowLevels {
  /// As TreeLevels'.
  std::vector<uint32_t> classes;
  /// Level of the edge from each corner to the next.
  std::vector<std::array<float, 3>> edges;
};

/// Draws trees and snow off-screen with tessellation shaders, on a GPU thread of its process;
/// OpenGL 4.5, on software renderers slowly. Same input, same driver: bit-identical pictures.
///
/// Method: D. T. Reynolds, PhD thesis, University of East Anglia, 2014, sections 3.4
/// and 4.2.2.
class Renderer {
 public:
  /// `device` as GpuThread's. @throws std::runtime_error where no context can be made.
  explicit Renderer(const std::string& device = "");
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // All: @throws std::invalid_argument for names that are not there (or are, when adding) and for
  // bad input; std::runtime_error when closed, and for the GPU's own errors.

  void add_tree(const std::string& name, const TreeSource& source, const TreeLook& look = {});
  /// Leaves of a tree, which move with its bones; replaces those that it has.
  void set_leaves(const std::string& tree, const LeafSource& leaves);
  /// A matrix a bone from the rest pose to the pose; the only upload of a frame.
  void set_pose(const std::string& tree, const std::vector<glm::mat4>& matrices);
  void add_mesh(const std::string& name, const MeshSource& source);
  /// A mesh that carries snow: bare until it gets a map.
  void add_snow_mesh(const std::string& name, const SnowSource& source);
  /// Moves such a mesh; `normals` as SnowSource's.
  void set_snow_pose(const std::string& mesh, const std::vector<glm::vec3>& positions,
                     const std::vector<std::array<glm::vec3, 3>>& normals = {});
  /// The snow on such a mesh, or on a tree that has places for it.
  void set_snow(const std::string& name, const HeightMap& heights);
  /// The snow on a mesh from a texture (R32F, linear filtering) where it lies, if that is in this
  /// renderer's context: whether it is. To be called anew when its content has changed. Trees take
  /// no textures: false.
  bool share_snow(const std::string& name, const gpu::ThreadTexture& heights);
  /// Takes a tree or a mesh away.
  void remove(const std::string& name);

  Picture render(const Camera& camera, const RenderSettings& settings);
  /// @throws std::runtime_error before the first picture.
  FrameStatistics statistics() const;

  /// World positions of the triangles of a tree or of a mesh with snow as the camera would see
  /// them, three a triangle, the plain patches first; what the camera does not see is left out.
  std::vector<glm::vec3> triangles(const std::string& name, const Camera& camera,
                                   const RenderSettings& settings);
  TreeLevels levels(const std::string& tree) const;
  SnowLevels snow_levels(const std::string& mesh) const;

  /// The driver.
  const gpu::GpuInfo& info() const;
  /// Frees the GPU's memory; calls after it throw.
  void close();

 private:
  Scene& scene() const;

  std::shared_ptr<gpu::GpuThread> thread_;
  std::unique_ptr<Scene> scene_;
};

}  // namespace snowbough::render
