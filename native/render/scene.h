#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gpu/timer.h"
#include "render/drawables.h"
#include "render/renderer.h"
#include "render/snow/flakes.h"
#include "render/snow/snow_passes.h"
#include "render/targets.h"
#include "render/tree_passes.h"

namespace snowbough::render {

/// The renderer's part on the GPU thread: what it draws, and the passes of a frame in order. All of
/// its functions run there; they mean what Renderer's mean.
class Scene {
 public:
  void add_tree(const std::string& name, const TreePatches& patches, const TreeLook& look);
  void set_leaves(const std::string& tree, const LeafSource& leaves);
  void set_pose(const std::string& tree, const std::vector<glm::mat4>& matrices);
  void add_mesh(const std::string& name, const MeshSource& source);
  void add_snow_mesh(const std::string& name, SnowMesh&& mesh, const glm::vec3& color);
  void set_snow_pose(const std::string& mesh, const std::vector<glm::vec3>& positions,
                     const std::vector<std::array<glm::vec3, 3>>& normals);
  void set_snow(const std::string& mesh, const HeightMap& heights);
  bool share_snow(const std::string& mesh, std::shared_ptr<const gpu::Texture> heights);
  void remove(const std::string& name);
  Picture render(const Camera& camera, const RenderSettings& settings);
  FrameStatistics statistics() const;
  std::vector<glm::vec3> triangles(const std::string& name, const Camera& camera,
                                   const RenderSettings& settings);
  TreeLevels levels(const std::string& tree) const;
  SnowLevels snow_levels(const std::string& mesh) const;

 private:
  using Kind = DrawKind;

  /// A mesh with snow.
  struct Receiver {
    Receiver(SnowMesh&& its_mesh, const glm::vec3& color)
        : mesh(std::move(its_mesh)), buffers(mesh.patches(), color) {}

    SnowMesh mesh;
    SnowBuffers buffers;
  };

  struct Tree {
    Tree(const TreePatches& patches, const TreeLook& its_look);

    TreeBuffers buffers;
    std::optional<LeafBuffers> leaves;
    TreeLook look;
    int32_t bone_count = 0;
    int32_t levels = 1;
    float largest_area = 0.0f;
    glm::vec3 lowest{0.0f};
    glm::vec3 highest{0.0f};
    /// Per quad: its edges.
    std::vector<glm::ivec4> patch_edges;
    /// A TreeView each.
    gpu::Buffer camera_view;
    gpu::Buffer sun_view;
  };

  Tree& tree(const std::string& name) const;
  Receiver& receiver(const std::string& name) const;
  void require_new(const std::string& name) const;
  Bounds bounds() const;
  void write_views(const Camera& camera, const RenderSettings& settings);
  void prepare_trees(const RenderSettings& settings);
  void prepare_snow(const RenderSettings& settings);
  void draw_shadows(const RenderSettings& settings);
  void draw_all(const DrawStyle& style, bool cull_back_faces, bool measured);
  void draw_snow(const DrawStyle& style, bool measured);
  void draw_picture(const Target& target, const RenderSettings& settings);
  void count_all_patches();
  /// Positions that two draws hand to transform feedback, the first's `list`'s plain patches.
  std::vector<glm::vec3> captured(const PatchList& list,
                                  const std::function<void(Kind)>& draw_plain,
                                  const std::function<void(Kind)>& draw_tessellated);

  std::map<std::string, std::unique_ptr<Tree>> trees_;
  std::map<std::string, std::unique_ptr<MeshBuffers>> meshes_;
  std::map<std::string, std::unique_ptr<Receiver>> receivers_;
  /// Of all but trees, which bring their own.
  gpu::Buffer camera_view_{sizeof(shared::TreeView)};
  gpu::Buffer sun_view_{sizeof(shared::TreeView)};

  TreePasses passes_;
  SnowPasses snow_;
  FlakePass flakes_;
  DrawablePasses drawables_;
  gpu::VertexArray no_vertices_;
  KeptTarget picture_{true};
  KeptTarget large_{true};
  KeptTarget shadow_{false};
  KeptTarget nothing_{false};
  const gpu::Texture* shadow_map_ = nullptr;
  gpu::PassTimer timer_{gpu::renders_in_software()};
  std::optional<FrameStatistics> statistics_;
};

}  // namespace snowbough::render
