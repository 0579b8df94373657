#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "gpu/program_variants.h"
#include "gpu/resources.h"
#include "render/data/sources.h"
#include "render/draw/draw_kind.h"
#include "render/draw/posed_bounds.h"

namespace snowbough::render {

/// A mesh on the GPU, split by material and into pieces that fit into a storage block.
class MeshBuffers {
 public:
  /// Places the mesh once, with the identity matrix.
  /// @throws std::invalid_argument with the reason: arrays of different lengths, indices out of
  /// range, or images whose bytes do not match their size.
  explicit MeshBuffers(const MeshSource& source);

  /// Sets the instances: a matrix for each, from the mesh's own space to the world.
  void set_instances(const std::vector<glm::mat4>& matrices);
  /// Sets the snow on the mesh; a map without heights removes it.
  /// @throws std::invalid_argument if the arrays do not match the mesh or one another.
  void set_snow(const MeshSnow& snow);

  /// Bounding box of all instances.
  const Box& bounds() const { return bounds_; }

 private:
  friend class MeshPasses;
  struct Piece {
    int32_t material = 0;
    /// Indices of the source's triangles in this piece.
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
  gpu::Buffer matrices_;
  int32_t instance_count_ = 0;
  gpu::Texture snow_heights_;
  Box own_;
  Box bounds_;
};

/// Draws meshes of every kind except kCapture. GPU thread.
class MeshPasses {
 public:
  void draw(MeshBuffers& mesh, const gpu::Buffer& view, const DrawStyle& style);

 private:
  gpu::ProgramVariants mesh_{{"mesh.vert.glsl", "mesh.frag.glsl"}};
};

}  // namespace snowbough::render
