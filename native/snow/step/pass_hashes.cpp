#include "snow/step/pass_hashes.h"

#include "snow/state/check_sum.h"

namespace snowbough::snow {

template <typename Item>
void PassHasher::add(const char* pass, const std::string& object, const std::vector<Item>& data) {
  const auto* bytes = reinterpret_cast<const char*>(data.data());
  hashes_->push_back({step_, pass, object, check_sum({bytes, data.size() * sizeof(Item)})});
}

void PassHasher::inputs(const shared::ProjectionFrame& frame) {
  if (hashes_ == nullptr) return;
  for (const SceneObject* object : objects_) {
    add("positions", object->description.name, object->positions);
  }
  add("projection", "all", std::vector{frame});
}

void PassHasher::triangles() {
  if (hashes_ == nullptr) return;
  for (size_t i = 0; i < objects_.size(); ++i) {
    add("triangles", objects_[i]->description.name,
        engine_.read_triangles(
            {engine_.layout().first_triangle[i], objects_[i]->triangle_count()}));
  }
}

void PassHasher::occlusion(const Tile& tile) {
  if (hashes_ == nullptr) return;
  add("occlusion",
      "tile " + std::to_string(tile.pixels.low.x) + " " + std::to_string(tile.pixels.low.y),
      engine_.read_occlusion(tile));
}

void PassHasher::deposit() {
  if (hashes_ == nullptr) return;
  for (size_t i = 0; i < objects_.size(); ++i) {
    if (!objects_[i]->description.receive) continue;
    const std::vector<TexelGain> gains = engine_.read_gains(i);
    if (!gains.empty()) add("deposit", objects_[i]->description.name, gains);
  }
}

void PassHasher::heights(const char* pass) {
  if (hashes_ == nullptr) return;
  std::vector<float> height;
  for (size_t i = 0; i < objects_.size(); ++i) {
    if (!objects_[i]->description.receive) continue;
    const auto side = static_cast<size_t>(objects_[i]->description.topology.resolution);
    height.resize(side * side);
    engine_.read_height(i, height);
    add(pass, objects_[i]->description.name, height);
  }
}

void PassHasher::statistics() {
  if (hashes_ == nullptr) return;
  for (size_t i = 0; i < objects_.size(); ++i) {
    if (!objects_[i]->description.receive) continue;
    add("statistics", objects_[i]->description.name, std::vector{engine_.read_sums(i)});
  }
}

}  // namespace snowbough::snow
