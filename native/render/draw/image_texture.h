#pragma once

#include <vector>

#include "gpu/resources.h"
#include "render/data/sources.h"

namespace snowbough::render {

/// Uploads an image as a texture for linear light, with repeat and filtering. `what` names the
/// image in messages. GPU thread.
/// @throws std::invalid_argument if the image's bytes do not match its size.
gpu::Texture image_texture(const Image& image, const char* what);

/// Uploads the images of materials, multiplied by the materials' colours, as the layers of one
/// texture with mip levels, repeat and filtering. Each layer has the size of the largest image;
/// smaller images are enlarged by nearest texel. Needs at least one material. GPU thread.
/// @throws as image_texture.
gpu::Texture material_layers(const std::vector<Material>& materials, const char* what);

}  // namespace snowbough::render
