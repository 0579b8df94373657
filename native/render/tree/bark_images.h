#pragma once

#include <cstddef>

#include "gpu/resources.h"
#include "render/sources.h"

namespace snowbough::render {

/// Images of a tree's bark on the GPU.
struct BarkImages {
  /// For a tree of `patches` quads. GPU thread.
  /// @throws std::invalid_argument naming what is wrong: arrays of another length, no materials,
  ///   indices out of range, images whose bytes do not fit their size.
  BarkImages(const BarkSource& source, size_t patches);

  /// A shared::BarkPlace a patch.
  gpu::Buffer places;
  /// A layer a material.
  gpu::Texture layers;
};

}  // namespace snowbough::render
