#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gpu/gl_context.h"
#include "gpu/timer.h"
#include "render/data/pictures.h"
#include "render/scene_objects.h"
#include "render/shadow_map.h"
#include "render/snow/flakes.h"
#include "render/targets.h"
#include "render/tree/forest.h"
#include "render/tree/leaf_passes.h"
#include "render/tree/tree_passes.h"

namespace snowbough::render {

/// Draws frames of a scene: the passes, in order. All functions run on the GPU thread and have the
/// same meaning as Renderer's.
class FrameDrawing {
 public:
  /// `objects` must outlive it.
  explicit FrameDrawing(const SceneObjects& objects)
      : objects_(objects), forest_(objects.most_bytes()) {}

  Picture render(const Camera& camera, const RenderSettings& settings);
  LightPicture render_light(const Camera& camera, const RenderSettings& settings, int32_t samples);
  DepthPicture render_depth(const Camera& camera, const RenderSettings& settings);
  /// Draws a picture of linear light without timing it, so that nothing blocks.
  const gpu::Texture& draw_light(const Camera& camera, const RenderSettings& settings,
                                 Shadows shadows = Shadows::kIfOther);
  FrameStatistics statistics() const;
  std::vector<glm::vec3> triangles(const std::string& name, const Camera& camera,
                                   const RenderSettings& settings);
  TreeLevels levels(const std::string& tree) const;

 private:
  shared::TreeView write_views(const Camera& camera, const RenderSettings& settings, bool linear);
  /// `shadows`: also for the shadow map.
  void prepare_trees(const shared::TreeView& view, const RenderSettings& settings, bool shadows);
  void draw_shadows(const RenderSettings& settings);
  void draw_all(const DrawStyle& style, bool cull_back_faces, bool measured);
  void draw_picture(const Target& target, const RenderSettings& settings, bool linear);
  void draw_frame(const Camera& camera, const RenderSettings& settings, const Target& target,
                  ReusedTarget& large, bool linear, Shadows shadows);
  void count_all_patches();
  /// Positions that the draws of a tree's chain write to transform feedback, the plain patches
  /// first.
  std::vector<glm::vec3> captured(TreeChain& chain, const RenderSettings& settings);

  const SceneObjects& objects_;
  gpu::Buffer camera_view_{sizeof(shared::TreeView)};
  gpu::Buffer sun_view_{sizeof(shared::TreeView)};

  Forest forest_;
  TreePasses passes_;
  FlakePass flakes_;
  LeafPasses leaf_passes_;
  MeshPasses mesh_passes_;
  gpu::Program sum_{{"frame_sum.comp.glsl"}};
  gpu::VertexArray no_vertices_;
  ReusedTarget picture_{GL_RGBA8};
  ReusedTarget large_{GL_RGBA8};
  ReusedTarget light_{GL_RGBA16F};
  ReusedTarget large_light_{GL_RGBA16F};
  ShadowMap shadow_;
  ReusedTarget nothing_{GL_NONE};
  gpu::PassTimer timer_{gpu::renders_in_software()};
  std::optional<FrameStatistics> statistics_;
};

}  // namespace snowbough::render
