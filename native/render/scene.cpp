#include "render/scene.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>

namespace snowbough::render {
namespace {

using glm::vec3;
using glm::vec4;

const vec4 kPaper(1.0f, 1.0f, 1.0f, 1.0f);
const vec4 kInk(0.05f, 0.08f, 0.15f, 1.0f);
/// How far a pose may take a tree out of its box at rest, in radii.
constexpr float kRoomToMove = 1.25f;

/// Pixels of a work group's side.
constexpr int32_t kTileSize = 8;

/// Whether a box is that of ground: it casts no shadows worth texels of the shadow map, which would
/// have to cover all of it.
bool is_flat(const Box& box) {
  constexpr float kFlat = 0.02f;
  const vec3 size = box.size();
  return size.z < kFlat * std::max(size.x, size.y);
}

/// Where in a pixel's tent filter, two pixels wide, a sample of a frame lies.
/// Source: M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018.
glm::vec2 sample_offset(int32_t index) {
  const auto tent = [&](double step) {
    const double share = std::fmod(0.5 + step * index, 1.0);
    return static_cast<float>(share < 0.5 ? std::sqrt(2.0 * share) - 1.0
                                          : 1.0 - std::sqrt(2.0 * (1.0 - share)));
  };
  return {tent(0.7548776662466927), tent(0.5698402909980532)};
}

/// Sets what the passes need and puts it back, because snow shares the context.
class DrawState {
 public:
  DrawState() {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
  }
  ~DrawState() {
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_POLYGON_OFFSET_FILL);
    glDisable(GL_RASTERIZER_DISCARD);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glBindVertexArray(0);
  }
  DrawState(const DrawState&) = delete;
  DrawState& operator=(const DrawState&) = delete;
};

float encoded(float linear) {
  const float c = std::clamp(linear, 0.0f, 1.0f);
  return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
}

}  // namespace

Scene::Tree::Tree(const TreePatches& patches, const TreeLook& its_look)
    : buffers(patches),
      look(its_look),
      bone_count(patches.bone_count),
      levels(patches.levels),
      largest_area(patches.largest_area),
      rest(patches.bone_count),
      camera_view(sizeof(shared::TreeView)),
      sun_view(sizeof(shared::TreeView)) {
  for (const shared::TreePatch& patch : patches.patches) {
    patch_edges.push_back(patch.edges);
  }
  for (const shared::TreeVertex& vertex : patches.vertices) {
    for (int k = 0; k < 4; ++k) {
      if (vertex.weights[k] > 0.0f) rest.add(vertex.bones[k], vec3(vertex.position));
    }
  }
  bounds = rest.at_rest();
}

Scene::Tree& Scene::tree(const std::string& name) const {
  const auto found = trees_.find(name);
  if (found == trees_.end()) throw std::invalid_argument("there is no tree '" + name + "'");
  return *found->second;
}

bool Scene::ShadowInputs::sees(const ShadowInputs& before, bool roughly) const {
  const bool same_sun = scene == before.scene && resolution == before.resolution &&
                        shadow_from_world == before.shadow_from_world;
  const bool same_levels = eye == before.eye && level == before.level && drop == before.drop &&
                           max_level == before.max_level && thesis == before.thesis;
  return same_sun && (roughly || same_levels);
}

MeshBuffers& Scene::mesh(const std::string& name) const {
  const auto found = meshes_.find(name);
  if (found == meshes_.end()) throw std::invalid_argument("there is no mesh '" + name + "'");
  return *found->second;
}

void Scene::require_new(const std::string& name) const {
  if (trees_.count(name) != 0 || meshes_.count(name) != 0) {
    throw std::invalid_argument("'" + name + "' is there already: remove it first");
  }
}

void Scene::add_tree(const std::string& name, const TreePatches& patches, const TreeLook& look) {
  ++revision_;
  require_new(name);
  trees_[name] = std::make_unique<Tree>(patches, look);
}

void Scene::set_leaves(const std::string& name, const LeafSource& leaves) {
  ++revision_;
  Tree& of = tree(name);
  LeafBuffers made(leaves, of.bone_count);
  of.leaves.reset();
  of.leaves.emplace(std::move(made));
  for (size_t i = 0; i < leaves.positions.size(); ++i) {
    of.rest.add(leaves.bone[i / 3], leaves.positions[i]);
    of.bounds.add(leaves.positions[i]);
  }
}

void Scene::set_pose(const std::string& name, const std::vector<glm::mat4>& matrices) {
  ++revision_;
  Tree& of = tree(name);
  if (matrices.size() != static_cast<size_t>(of.bone_count)) {
    throw std::invalid_argument("tree '" + name + "' has " + std::to_string(of.bone_count) +
                                " bones, not " + std::to_string(matrices.size()));
  }
  const std::vector<vec4> rows = bone_rows(matrices);
  of.buffers.bones.write(0, static_cast<int64_t>(rows.size() * sizeof(vec4)), rows.data());
  of.bounds = of.rest.posed(matrices);
}

void Scene::add_mesh(const std::string& name, const MeshSource& source) {
  ++revision_;
  require_new(name);
  meshes_[name] = std::make_unique<MeshBuffers>(source);
}

void Scene::set_places(const std::string& name, const std::vector<glm::mat4>& matrices) {
  ++revision_;
  mesh(name).set_places(matrices);
}

void Scene::set_mesh_snow(const std::string& name, const MeshSnow& snow) {
  mesh(name).set_snow(snow);
}

void Scene::remove(const std::string& name) {
  ++revision_;
  if (trees_.erase(name) + meshes_.erase(name) == 0) {
    throw std::invalid_argument("there is nothing named '" + name + "'");
  }
}

Bounds Scene::bounds() const {
  Box casters, all;
  for (const auto& [name, of] : trees_) casters.add(of->bounds);
  for (const auto& [name, of] : meshes_) {
    if (of->bounds().is_empty()) continue;
    all.add(of->bounds());
    if (!is_flat(of->bounds())) casters.add(of->bounds());
  }
  if (casters.is_empty()) casters = all;
  if (casters.is_empty()) return {vec3(0.0f), 10.0f, 10.0f};
  const float radius = std::max(kRoomToMove * 0.5f * glm::length(casters.size()), 1e-6f);
  return {casters.centre(), radius, radius};
}

shared::TreeView Scene::write_views(const Camera& camera, const RenderSettings& settings,
                                    bool linear) {
  Bounds around = bounds();
  // Meshes, as the ground, reach beyond the trees: nothing in front of the camera is cut off.
  around.reach = meshes_.empty() ? around.radius : std::numeric_limits<float>::max();
  const shared::TreeView base = camera_view(camera, settings, around, linear);
  const auto write = [](gpu::Buffer& buffer, const shared::TreeView& view) {
    buffer.write(0, sizeof view, &view);
  };
  write(camera_view_, base);
  write(sun_view_, sun_view(base));
  for (const auto& [name, of] : trees_) {
    shared::TreeView view = base;
    if (settings.max_area == 0.0f) view.thesis.y = of->largest_area;
    view.thesis.z = static_cast<float>(of->levels);
    view.bark_dark = vec4(of->look.bark_dark, 1.0f);
    view.bark_light = vec4(of->look.bark_light, 1.0f);
    write(of->camera_view, view);
    write(of->sun_view, sun_view(view));
  }
  return base;
}

void Scene::prepare_trees(const RenderSettings& settings) {
  const auto each = [&](const char* pass, auto&& work) {
    const auto measured = timer_.measure(pass);
    for (const auto& [name, of] : trees_) work(*of);
  };
  each("pose", [&](Tree& of) { passes_.pose(of.buffers, of.camera_view); });
  each("edges", [&](Tree& of) { passes_.edge_levels(of.buffers, of.camera_view); });
  each("classify", [&](Tree& of) {
    passes_.classify(of.buffers, of.buffers.camera, of.camera_view, settings.max_level);
  });
}

void Scene::draw_shadows(const RenderSettings& settings) {
  const int32_t size = std::max(settings.shadow_resolution, 1);
  const Target& target = shadow_.of_size(size, size);
  shadow_map_ = &target.depth;
  target.begin(0.0f, 0.0f, 0.0f);
  if (settings.shadow_resolution == 0) return;
  const auto measured = timer_.measure("shadow");
  glDisable(GL_CULL_FACE);
  for (const auto& [name, of] : trees_) {
    TreeDrawList& list = of->buffers.sun;
    passes_.classify(of->buffers, list, of->sun_view, settings.max_level);
    passes_.draw_plain(of->buffers, list, of->sun_view, Kind::kDepth, *shadow_map_, kInk);
    passes_.draw_tessellated(of->buffers, list, of->sun_view, Kind::kDepth, *shadow_map_, kInk);
    if (of->leaves) {
      drawables_.draw_leaves(*of->leaves, of->buffers.bones, of->sun_view, Kind::kDepth,
                             *shadow_map_, kInk);
    }
  }
  for (const auto& [name, mesh] : meshes_) {
    mesh_passes_.draw(*mesh, sun_view_, Kind::kDepth, *shadow_map_, kInk);
  }
}

void Scene::draw_all(Kind kind, const vec4& wire_color, bool cull_back_faces, bool measured) {
  const auto pass = [&](const char* name, auto&& work) {
    if (!measured) return work();
    const auto timed = timer_.measure(name);
    work();
  };
  (cull_back_faces ? glEnable : glDisable)(GL_CULL_FACE);
  pass("plain", [&] {
    for (const auto& [name, of] : trees_) {
      passes_.draw_plain(of->buffers, of->buffers.camera, of->camera_view, kind, shadow_map(),
                         wire_color);
    }
  });
  pass("tessellated", [&] {
    for (const auto& [name, of] : trees_) {
      passes_.draw_tessellated(of->buffers, of->buffers.camera, of->camera_view, kind, shadow_map(),
                               wire_color);
    }
  });
  glDisable(GL_CULL_FACE);
  pass("leaves", [&] {
    for (const auto& [name, of] : trees_) {
      if (of->leaves) {
        drawables_.draw_leaves(*of->leaves, of->buffers.bones, of->camera_view, kind, shadow_map(),
                               wire_color);
      }
    }
  });
  pass("meshes", [&] {
    for (const auto& [name, mesh] : meshes_) {
      mesh_passes_.draw(*mesh, camera_view_, kind, shadow_map(), wire_color);
    }
  });
}

void Scene::draw_picture(const Target& target, const RenderSettings& settings, bool linear) {
  if (!settings.wireframe) {
    const vec3 sky = settings.background.value_or(settings.sky_color);
    const vec3 clear = linear ? sky : vec3(encoded(sky.r), encoded(sky.g), encoded(sky.b));
    target.begin(clear.r, clear.g, clear.b);
    draw_all(Kind::kShaded, kInk, settings.cull_back_faces, true);
    return;
  }
  target.begin(1.0f, 1.0f, 1.0f);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.0f, 1.0f);
  draw_all(Kind::kWire, kPaper, settings.cull_back_faces, false);
  glDisable(GL_POLYGON_OFFSET_FILL);
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  draw_all(Kind::kWire, kInk, settings.cull_back_faces, true);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

void Scene::count_patches() {
  for (const auto& [name, of] : trees_) {
    const auto commands = of->buffers.camera.commands.read_all<shared::TreeDrawCommand>();
    const int64_t plain = commands[0].count / 6;
    int64_t tessellated = 0;
    for (int32_t i = 1; i <= of->buffers.camera.draws; ++i) tessellated += commands[i].count;
    statistics_->plain += plain;
    statistics_->tessellated += tessellated;
    statistics_->dropped += of->buffers.patch_count - plain - tessellated;
  }
}

void Scene::draw_frame(const Camera& camera, const RenderSettings& settings, const Target& target,
                       KeptTarget& large, bool linear, Shadows shadows) {
  const DrawState state;
  glBindVertexArray(no_vertices_.id());
  Camera of_pixels = camera;
  RenderSettings for_pixels = settings;
  if (settings.antialias) {
    of_pixels.width *= 2;
    of_pixels.height *= 2;
    for_pixels.target_pixels *= 2.0f;
    for_pixels.min_pixels *= 2.0f;
  }
  const shared::TreeView view = write_views(of_pixels, for_pixels, linear);
  prepare_trees(settings);
  const ShadowInputs inputs{revision_,
                            settings.shadow_resolution,
                            view.shadow_from_world,
                            vec3(view.eye),
                            view.eye.w / view.tessellation.z,
                            view.eye.w / view.tessellation.w,
                            view.tessellation.y,
                            view.thesis};
  const bool stays = shadows == Shadows::kKeep || (shadows == Shadows::kIfOther && shadow_inputs_ &&
                                                   inputs.sees(*shadow_inputs_, settings.draft));
  if (!stays) {
    draw_shadows(settings);
    shadow_inputs_ = inputs;
  }
  if (settings.antialias) {
    const Target& twice = large.of_size(of_pixels.width, of_pixels.height);
    draw_picture(twice, settings, linear);
    halve(twice, target);
  } else {
    draw_picture(target, settings, linear);
  }
}

Picture Scene::render(const Camera& camera, const RenderSettings& settings) {
  const auto started = std::chrono::steady_clock::now();
  timer_.take();
  const Target& picture = picture_.of_size(camera.width, camera.height);
  draw_frame(camera, settings, picture, large_, false, Shadows::kDraw);
  Picture made{camera.width, camera.height, read_color(picture)};

  statistics_.emplace();
  statistics_->wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  statistics_->passes = timer_.take();
  for (const gpu::PassTime& pass : statistics_->passes) {
    if (pass.name != "shadow") statistics_->triangles += static_cast<int64_t>(pass.primitives);
  }
  count_patches();
  return made;
}

const gpu::Texture& Scene::draw_light(const Camera& camera, const RenderSettings& settings,
                                      Shadows shadows) {
  const Target& picture = light_.of_size(camera.width, camera.height);
  timer_.set_enabled(false);
  draw_frame(camera, settings, picture, large_light_, true, shadows);
  timer_.set_enabled(true);
  return picture.color;
}

LightPicture Scene::render_light(const Camera& camera, const RenderSettings& settings,
                                 int32_t samples) {
  const gpu::Texture sum(GL_RGBA32F, camera.width, camera.height);
  Camera of_sample = camera;
  for (int32_t i = 0; i < samples; ++i) {
    if (samples > 1) of_sample.jitter = camera.jitter + sample_offset(i);
    const gpu::Texture& light =
        draw_light(of_sample, settings, i == 0 ? Shadows::kDraw : Shadows::kKeep);
    sum_.use();
    sum_.bind_texture("light", light);
    sum_.bind_image("sum", sum, GL_READ_WRITE);
    sum_.set("weight", 1.0f / static_cast<float>(samples));
    sum_.dispatch(gpu::group_count(camera.width, kTileSize),
                  gpu::group_count(camera.height, kTileSize));
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
  }
  LightPicture made{camera.width, camera.height, {}};
  made.rgba.resize(static_cast<size_t>(camera.width) * camera.height * 4);
  sum.read(0, GL_RGBA, GL_FLOAT, static_cast<int64_t>(made.rgba.size() * sizeof(float)),
           made.rgba.data());
  return made;
}

FrameStatistics Scene::statistics() const {
  if (!statistics_) throw std::runtime_error("statistics: render a picture first");
  return *statistics_;
}

std::vector<vec3> Scene::triangles(const std::string& name, const Camera& camera,
                                   const RenderSettings& settings) {
  Tree& of = tree(name);
  const DrawState state;
  glBindVertexArray(no_vertices_.id());
  // Nothing is drawn, yet draws want a framebuffer.
  nothing_.of_size(1, 1).begin(0.0f, 0.0f, 0.0f);
  glEnable(GL_RASTERIZER_DISCARD);
  write_views(camera, settings, false);
  passes_.pose(of.buffers, of.camera_view);
  passes_.edge_levels(of.buffers, of.camera_view);
  passes_.classify(of.buffers, of.buffers.camera, of.camera_view, settings.max_level);
  const gpu::Texture none;
  TreeDrawList& list = of.buffers.camera;
  const auto draw_plain = [&](Kind kind) {
    passes_.draw_plain(of.buffers, list, of.camera_view, kind, none, kInk);
  };
  const auto draw_tessellated = [&](Kind kind) {
    passes_.draw_tessellated(of.buffers, list, of.camera_view, kind, none, kInk);
  };
  timer_.take();
  {
    const auto counted = timer_.measure("count");
    draw_plain(Kind::kDepth);
    draw_tessellated(Kind::kDepth);
  }
  const uint64_t count = timer_.take()[0].primitives;
  const gpu::Buffer captured(static_cast<int64_t>(3 * count * sizeof(vec3)));
  const auto plain_corners = list.commands.read_all<shared::TreeDrawCommand>()[0].count;
  const auto split = static_cast<int64_t>(plain_corners * sizeof(vec3));
  const auto into = [&](int64_t offset, int64_t bytes, auto&& draw) {
    if (bytes == 0) return;
    glBindBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, 0, captured.id(), offset, bytes);
    draw(Kind::kCapture);
  };
  into(0, split, draw_plain);
  into(split, captured.bytes() - split, draw_tessellated);
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
  return captured.read_all<vec3>();
}

TreeLevels Scene::levels(const std::string& name) const {
  const Tree& of = tree(name);
  if (!statistics_) throw std::runtime_error("levels: render a picture first");
  const auto edges = of.buffers.edge_levels.read_all<float>();
  TreeLevels levels;
  levels.classes = of.buffers.camera.classes.read_all<uint32_t>();
  for (const glm::ivec4& patch : of.patch_edges) {
    levels.edges.push_back(
        {edges[patch.x >> 1], edges[patch.y >> 1], edges[patch.z >> 1], edges[patch.w >> 1]});
  }
  return levels;
}

}  // namespace snowbough::render
