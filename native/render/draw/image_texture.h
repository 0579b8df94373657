#pragma once

#include <vector>

#include "gpu/resources.h"
#include "render/sources.h"

namespace snowbough::render {

/// An image as shaders sample it: repeated, filtered, linear. `what` names it in messages. GPU
/// thread. @throws std::invalid_argument where its bytes do not fit its size.
gpu::Texture image_texture(const Image& image, const char* what);

/// Images of materials, times their colours, as the layers of one texture with mip levels, repeated
/// and filtered: each as large as the largest of them, by its nearest texels. At least one
/// material. GPU thread. @throws as image_texture.
gpu::Texture material_layers(const std::vector<Material>& materials, const char* what);

}  // namespace snowbough::render
