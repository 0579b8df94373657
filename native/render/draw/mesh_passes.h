#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <vector>

#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/draw/draw_kind.h"
#include "render/draw/posed_bounds.h"
#include "render/sources.h"

namespace snowbough::render {

/// A mesh on the GPU, by material and in pieces that a storage block holds.
class MeshBuffers {
 public:
  /// In one place, where it is.
  /// @throws std::invalid_argument naming what is wrong: arrays of different length, indices out of
  ///   range, images whose bytes do not fit their size.
  explicit MeshBuffers(const MeshSource& source);

  /// Where it is: a matrix a place, from its own space to the world.
  void set_places(const std::vector<glm::mat4>& matrices);
  /// Lets snow lie on it; without heights: none. @throws std::invalid_argument where the arrays do
  ///   not fit the mesh or one another.
  void set_snow(const MeshSnow& snow);

  /// Box around it in all of its places.
  const Box& bounds() const { return bounds_; }

 private:
  friend class MeshPasses;
  struct Piece {
    int32_t material = 0;
    /// Which triangles of the source they are.
    std::vector<int32_t> triangles;
    gpu::Buffer corners;
    gpu::Buffer snow_corners;
  };
  struct DrawnMaterial {
    glm::vec3 color{1.0f};
    gpu::Texture image;
  };

  bool is_snow_ = false;
  std::vector<Piece> pieces_;
  std::vector<DrawnMaterial> materials_;
  gpu::Buffer places_;
  int32_t place_count_ = 0;
  gpu::Texture snow_heights_;
  Box own_;
  Box bounds_;
};

/// Draws meshes. Kinds as the tree's, without kCapture. GPU thread.
class MeshPasses {
 public:
  void draw(MeshBuffers& mesh, const gpu::Buffer& view, const DrawStyle& style);

 private:
  gpu::ProgramVariants mesh_{{"mesh.vert.glsl", "mesh.frag.glsl"}};
};

}  // namespace snowbough::render
