#include <algorithm>
#include <stdexcept>

#include "render/scene.h"

namespace snowbough::render {
namespace {

using glm::vec3;

}  // namespace

Scene::Receiver& Scene::receiver(const std::string& name) const {
  const auto found = receivers_.find(name);
  if (found == receivers_.end()) {
    throw std::invalid_argument("there is no mesh with snow named '" + name + "'");
  }
  return *found->second;
}

void Scene::add_snow_mesh(const std::string& name, SnowMesh&& mesh, const vec3& color,
                          bool draws_base) {
  ++revision_;
  require_new(name);
  receivers_[name] = std::make_unique<Receiver>(std::move(mesh), color, draws_base);
}

void Scene::set_snow_pose(const std::string& name, const std::vector<vec3>& positions,
                          const std::vector<std::array<vec3, 3>>& normals) {
  ++revision_;
  Receiver& of = receiver(name);
  of.mesh.set_pose(positions, normals);
  of.buffers.set_pose(of.mesh.patches());
}

void Scene::set_snow(const std::string& name, const HeightMap& heights) {
  ++revision_;
  auto map = std::make_shared<gpu::Texture>(GL_R32F, heights.width, heights.height, 0, GL_LINEAR);
  map->write(0, GL_RED, GL_FLOAT, heights.values.data());
  if (trees_.count(name) == 0) return receiver(name).buffers.set_map(std::move(map));
  Tree& of = tree_with_places(name);
  // A bare tree is drawn by the shaders without snow.
  const bool is_bare = std::all_of(heights.values.begin(), heights.values.end(),
                                   [](float height) { return height == 0.0f; });
  of.buffers.set_snow(is_bare ? nullptr : std::move(map));
}

Scene::Tree& Scene::tree_with_places(const std::string& name) const {
  Tree& of = tree(name);
  if (!of.has_snow_places) {
    throw std::invalid_argument("tree '" + name + "' has no places on a map: give it its snow_uv");
  }
  return of;
}

void Scene::share_snow(const std::string& name, std::shared_ptr<const gpu::Texture> heights) {
  ++revision_;
  if (trees_.count(name) != 0) {
    tree_with_places(name).buffers.set_snow(std::move(heights));
  } else {
    receiver(name).buffers.set_map(std::move(heights));
  }
}

void Scene::prepare_snow(const RenderSettings& settings) {
  if (receivers_.empty()) return;
  const auto each = [&](const char* pass, auto&& work) {
    const auto measured = timer_.measure(pass);
    for (const auto& [name, of] : receivers_) work(of->buffers);
  };
  each("snow lay", [&](SnowBuffers& of) { snow_.lay(of); });
  each("snow edges", [&](SnowBuffers& of) { snow_.edge_levels(of, camera_view_); });
  each("snow classify", [&](SnowBuffers& of) {
    snow_.patches.classify(of, of.camera, camera_view_, settings.max_level);
  });
}

void Scene::draw_snow(const DrawStyle& style, bool measured, bool layers) {
  const auto drawn = [&](const Receiver& of) { return of.draws_base() != layers; };
  if (std::none_of(receivers_.begin(), receivers_.end(),
                   [&](const auto& each) { return drawn(*each.second); })) {
    return;
  }
  const auto pass = [&](const char* name, auto&& draw) {
    const auto all = [&] {
      for (const auto& [of_name, of] : receivers_) {
        if (drawn(*of)) draw(*of);
      }
    };
    if (!measured) return all();
    const auto timed = timer_.measure(name);
    all();
  };
  pass(layers ? "layers plain" : "snow plain", [&](Receiver& of) {
    snow_.patches.draw_plain(of.buffers, of.buffers.camera, camera_view_, style);
  });
  pass(layers ? "layers tessellated" : "snow tessellated", [&](Receiver& of) {
    snow_.patches.draw_tessellated(of.buffers, of.buffers.camera, camera_view_, style);
  });
}

void Scene::draw_snow_layers(const DrawStyle& style, bool measured) {
  if (style.kind != Kind::kShaded) return draw_snow(style, measured, true);
  // Thin snow shows what it lies on, and lies closer to it than depth tells apart from afar.
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(-1.0f, -4.0f);
  draw_snow(style, measured, true);
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDisable(GL_BLEND);
}

SnowLevels Scene::snow_levels(const std::string& name) const {
  const Receiver& of = receiver(name);
  if (!statistics_) throw std::runtime_error("snow_levels: render a picture first");
  const auto edges = of.buffers.edge_levels.read_all<float>();
  SnowLevels levels;
  levels.classes = of.buffers.camera.classes.read_all<uint32_t>();
  for (const shared::SnowPatch& patch : of.mesh.patches().patches) {
    const glm::ivec4& edge = patch.edges;
    levels.edges.push_back({edges[edge.x >> 1], edges[edge.y >> 1], edges[edge.z >> 1]});
  }
  return levels;
}

}  // namespace snowbough::render
