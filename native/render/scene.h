#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gpu/timer.h"
#include "render/draw/mesh_passes.h"
#include "render/draw/posed_bounds.h"
#include "render/renderer.h"
#include "render/snow/flakes.h"
#include "render/targets.h"
#include "render/tree/leaf_passes.h"
#include "render/tree/tree_passes.h"

namespace snowbough::render {

/// The renderer's part on the GPU thread: the scene (scene.cpp, scene_trees.cpp) and the passes of
/// a frame in order (scene_frames.cpp). All functions run on that thread and have the same meaning
/// as Renderer's.
class Scene {
 public:
  void add_tree(const std::string& name, const TreePatches& patches, const TreeLook& look);
  void set_leaves(const std::string& tree, const LeafSource& leaves);
  void set_bark(const std::string& tree, const BarkSource& bark);
  void set_pose(const std::string& tree, const std::vector<glm::mat4>& matrices);
  void add_mesh(const std::string& name, const MeshSource& source);
  void set_snow(const std::string& tree, const TreeSnow& snow);
  void share_snow(const std::string& tree, std::shared_ptr<const gpu::Texture> heights,
                  const SnowDepths& depths);
  void remove(const std::string& name);
  void set_places(const std::string& mesh, const std::vector<glm::mat4>& matrices);
  void set_mesh_snow(const std::string& mesh, const MeshSnow& snow);
  Picture render(const Camera& camera, const RenderSettings& settings);
  LightPicture render_light(const Camera& camera, const RenderSettings& settings, int32_t samples);
  DepthPicture render_depth(const Camera& camera, const RenderSettings& settings);
  /// When a frame draws the shadow map.
  enum class Shadows : uint8_t {
    kDraw,
    /// Draws it only if its inputs have changed since the last frame.
    kIfOther,
    kKeep,
  };
  /// Draws a picture of linear light without timing it, so that nothing blocks.
  const gpu::Texture& draw_light(const Camera& camera, const RenderSettings& settings,
                                 Shadows shadows = Shadows::kIfOther);
  FrameStatistics statistics() const;
  std::vector<glm::vec3> triangles(const std::string& name, const Camera& camera,
                                   const RenderSettings& settings);
  TreeLevels levels(const std::string& tree) const;

 private:
  using Kind = DrawKind;

  struct Tree {
    Tree(const TreePatches& patches, const TreeLook& its_look);

    TreeBuffers buffers;
    std::optional<LeafBuffers> leaves;
    TreeLook look;
    int32_t bone_count = 0;
    int32_t levels = 1;
    bool has_snow_places = false;
    float largest_area = 0.0f;
    PosedBounds rest;
    Box bounds;
    /// Edges of each quad.
    std::vector<glm::ivec4> patch_edges;
    /// Each holds one TreeView.
    gpu::Buffer camera_view;
    gpu::Buffer sun_view;
  };

  /// Inputs of the shadow map.
  struct ShadowInputs {
    uint64_t scene = 0;
    int32_t resolution = 0;
    glm::mat4 shadow_from_world{0.0f};
    /// The shadow map uses the tessellation levels of the camera's picture.
    glm::vec3 eye{0.0f};
    float level = 0.0f;
    float drop = 0.0f;
    float max_level = 0.0f;
    glm::vec4 thesis{0.0f};

    /// True if the shadow map for `before` can be reused. `roughly`: also if only the camera has
    /// moved.
    bool sees(const ShadowInputs& before, bool roughly) const;
  };

  Tree& tree(const std::string& name) const;
  Tree& tree_with_places(const std::string& name) const;
  MeshBuffers& mesh(const std::string& name) const;
  void require_new(const std::string& name) const;
  Bounds bounds() const;
  shared::TreeView write_views(const Camera& camera, const RenderSettings& settings, bool linear);
  void prepare_trees(const RenderSettings& settings);
  void draw_shadows(const RenderSettings& settings);
  void draw_all(const DrawStyle& style, bool cull_back_faces, bool measured);
  void draw_picture(const Target& target, const RenderSettings& settings, bool linear);
  void draw_frame(const Camera& camera, const RenderSettings& settings, const Target& target,
                  KeptTarget& large, bool linear, Shadows shadows);
  void count_all_patches();
  /// Positions that the draws of the camera's list write to transform feedback, the plain patches
  /// first.
  std::vector<glm::vec3> captured(PatchPasses& passes, PatchSource& of, const gpu::Buffer& view,
                                  float max_level);

  std::map<std::string, std::unique_ptr<Tree>> trees_;
  std::map<std::string, std::unique_ptr<MeshBuffers>> meshes_;
  /// Views of all objects except trees, which have their own.
  gpu::Buffer camera_view_{sizeof(shared::TreeView)};
  gpu::Buffer sun_view_{sizeof(shared::TreeView)};

  TreePasses passes_;
  FlakePass flakes_;
  LeafPasses leaf_passes_;
  MeshPasses mesh_passes_;
  gpu::Program sum_{{"frame_sum.comp.glsl"}};
  gpu::VertexArray no_vertices_;
  KeptTarget picture_{GL_RGBA8};
  KeptTarget large_{GL_RGBA8};
  KeptTarget light_{GL_RGBA16F};
  KeptTarget large_light_{GL_RGBA16F};
  KeptTarget shadow_{GL_NONE};
  KeptTarget nothing_{GL_NONE};
  const gpu::Texture* shadow_map_ = nullptr;
  /// Counts changes to shadow casters.
  uint64_t revision_ = 0;
  std::optional<ShadowInputs> shadow_inputs_;
  gpu::PassTimer timer_{gpu::renders_in_software()};
  std::optional<FrameStatistics> statistics_;
};

}  // namespace snowbough::render
