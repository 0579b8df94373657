#pragma once

#include <cstddef>

#include "gpu/resources.h"
#include "render/data/sources.h"

namespace snowbough::render {

/// Images of a tree's bark on the GPU.
struct BarkImages {
  /// Uploads the images for a tree of `patches` quads. GPU thread.
  /// @throws std::invalid_argument with the reason: arrays of a different length, no materials,
  /// indices out of range, or images whose bytes do not match their size.
  BarkImages(const BarkSource& source, size_t patches);

  /// One shared::BarkPlace per patch.
  gpu::Buffer places;
  /// One layer per material.
  gpu::Texture layers;
};

}  // namespace snowbough::render
