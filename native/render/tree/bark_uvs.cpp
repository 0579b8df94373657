#include "render/tree/bark_uvs.h"

#include <stdexcept>
#include <string>

namespace snowbough::render {
namespace {

void require_bark(bool right, const std::string& what) {
  if (!right) throw std::invalid_argument("set_bark: " + what);
}

}  // namespace

std::vector<shared::BarkUv> bark_uvs(const BarkSource& source, const std::vector<int32_t>& quads) {
  require_bark(source.uv.size() == quads.size() && source.material.size() == quads.size(),
               "uv and materials must have one entry for each of the tree's " +
                   std::to_string(quads.size()) + " quads");
  require_bark(!source.materials.empty(), "it needs at least one material");
  const auto count = static_cast<int32_t>(source.materials.size());
  std::vector<shared::BarkUv> found;
  found.reserve(quads.size());
  for (const int32_t quad : quads) {
    const auto f = static_cast<size_t>(quad);
    const int32_t material = source.material[f];
    require_bark(material >= 0 && material < count,
                 "material index " + std::to_string(material) + " of quad " + std::to_string(f) +
                     " must be at least 0 and below " + std::to_string(count));
    const auto& uv = source.uv[f];
    found.push_back({glm::vec4(uv[0], uv[1]), glm::vec4(uv[2], uv[3]),
                     glm::vec4(static_cast<float>(material), 0.0f, 0.0f, 0.0f)});
  }
  return found;
}

}  // namespace snowbough::render
