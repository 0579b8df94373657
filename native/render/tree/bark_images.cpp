#include "render/tree/bark_images.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "render/draw/image_texture.h"
#include "shaders/lib/tree_shared.h"

namespace snowbough::render {
namespace {

void require_bark(bool right, const std::string& what) {
  if (!right) throw std::invalid_argument("set_bark: " + what);
}

std::vector<shared::BarkPlace> places_of(const BarkSource& source, size_t patches) {
  require_bark(source.uv.size() == patches && source.material.size() == patches,
               "uv and materials must have one entry for each of the tree's " +
                   std::to_string(patches) + " quads");
  require_bark(!source.materials.empty(), "it needs at least one material");
  const auto count = static_cast<int32_t>(source.materials.size());
  std::vector<shared::BarkPlace> places;
  places.reserve(patches);
  for (size_t f = 0; f < patches; ++f) {
    const int32_t material = source.material[f];
    require_bark(material >= 0 && material < count,
                 "material index " + std::to_string(material) + " of quad " + std::to_string(f) +
                     " must be at least 0 and below " + std::to_string(count));
    const auto& uv = source.uv[f];
    places.push_back({glm::vec4(uv[0], uv[1]), glm::vec4(uv[2], uv[3]),
                      glm::vec4(static_cast<float>(material), 0.0f, 0.0f, 0.0f)});
  }
  return places;
}

}  // namespace

BarkImages::BarkImages(const BarkSource& source, size_t patches)
    : places(places_of(source, patches)), layers(material_layers(source.materials, "set_bark")) {}

}  // namespace snowbough::render
