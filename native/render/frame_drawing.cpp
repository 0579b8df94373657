#include "render/frame_drawing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace snowbough::render {
namespace {

using glm::vec3;
using glm::vec4;

const vec4 kPaper(1.0f, 1.0f, 1.0f, 1.0f);
const vec4 kInk(0.05f, 0.08f, 0.15f, 1.0f);
/// Side of a work group, in pixels.
constexpr int32_t kTileSize = 8;

/// Offset of a frame's sample in the pixel's tent filter, which is two pixels wide.
glm::vec2 sample_offset(int32_t index) {
  const auto tent = [&](double step) {
    const double share = std::fmod(0.5 + step * index, 1.0);
    return static_cast<float>(share < 0.5 ? std::sqrt(2.0 * share) - 1.0
                                          : 1.0 - std::sqrt(2.0 * (1.0 - share)));
  };
  return {tent(0.7548776662466927), tent(0.5698402909980532)};
}

/// Sets the OpenGL state that the passes need and restores it afterwards, because the snow
/// simulation uses the same context.
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

shared::TreeView FrameDrawing::write_views(const Camera& camera, const RenderSettings& settings,
                                           bool linear) {
  Bounds around = objects_.bounds();
  // Meshes such as ground extend beyond the trees: nothing in front of the camera is clipped.
  around.reach = objects_.meshes().empty() ? around.radius : std::numeric_limits<float>::max();
  const shared::TreeView base = camera_view(camera, settings, around, linear);
  const auto write = [](gpu::Buffer& buffer, const shared::TreeView& view) {
    buffer.write(0, sizeof view, &view);
  };
  write(camera_view_, base);
  write(sun_view_, sun_view(base));
  for (const auto& [name, of] : objects_.trees()) {
    shared::TreeView view = base;
    if (settings.max_area == 0.0f) view.thesis.y = of->largest_area;
    view.thesis.z = static_cast<float>(of->levels);
    view.bark_dark = vec4(of->look.bark_dark, 1.0f);
    view.bark_light = vec4(of->look.bark_light, 1.0f);
    view.snow.y = of->buffers.snow_depths.open;
    view.snow.z = of->buffers.snow_depths.last;
    write(of->camera_view, view);
    write(of->sun_view, sun_view(view));
  }
  return base;
}

void FrameDrawing::prepare_trees(const RenderSettings& settings) {
  const auto each = [&](const char* pass, auto&& work) {
    const auto measured = timer_.measure(pass);
    for (const auto& [name, of] : objects_.trees()) work(*of);
  };
  each("pose", [&](SceneTree& of) { passes_.pose(of.buffers, of.camera_view); });
  each("edges", [&](SceneTree& of) { passes_.edge_levels(of.buffers, of.camera_view); });
  each("classify", [&](SceneTree& of) {
    passes_.patches.classify(of.buffers, of.buffers.camera, of.camera_view, settings.max_level);
    if (of.leaves) {
      leaf_passes_.classify(*of.leaves, &LeafBuffers::Part::camera, of.buffers.bones,
                            of.camera_view);
    }
  });
}

void FrameDrawing::draw_shadows(const RenderSettings& settings) {
  if (settings.shadow_resolution == 0) return;
  const auto measured = timer_.measure("shadow");
  glDisable(GL_CULL_FACE);
  const DrawStyle style{DrawKind::kDepth, shadow_.texture(), kInk};
  const auto draw = [&](PatchPasses& passes, PatchSource& of, const gpu::Buffer& view) {
    passes.classify(of, of.sun, view, settings.max_level);
    passes.draw_plain(of, of.sun, view, style);
    passes.draw_tessellated(of, of.sun, view, style);
  };
  for (const auto& [name, of] : objects_.trees()) {
    draw(passes_.patches, of->buffers, of->sun_view);
    if (of->leaves) {
      leaf_passes_.classify(*of->leaves, &LeafBuffers::Part::sun, of->buffers.bones, of->sun_view);
      leaf_passes_.draw(*of->leaves, &LeafBuffers::Part::sun, of->buffers.bones, of->sun_view,
                        style);
    }
  }
  for (const auto& [name, mesh] : objects_.meshes()) {
    mesh_passes_.draw(*mesh, sun_view_, style);
  }
}

void FrameDrawing::draw_all(const DrawStyle& style, bool cull_back_faces, bool measured) {
  const auto pass = [&](const char* name, auto&& work) {
    if (!measured) return work();
    const auto timed = timer_.measure(name);
    work();
  };
  (cull_back_faces ? glEnable : glDisable)(GL_CULL_FACE);
  pass("plain", [&] {
    for (const auto& [name, of] : objects_.trees()) {
      passes_.patches.draw_plain(of->buffers, of->buffers.camera, of->camera_view, style);
    }
  });
  pass("tessellated", [&] {
    for (const auto& [name, of] : objects_.trees()) {
      passes_.patches.draw_tessellated(of->buffers, of->buffers.camera, of->camera_view, style);
    }
  });
  glDisable(GL_CULL_FACE);
  pass("leaves", [&] {
    for (const auto& [name, of] : objects_.trees()) {
      if (of->leaves) {
        leaf_passes_.draw(*of->leaves, &LeafBuffers::Part::camera, of->buffers.bones,
                          of->camera_view, style);
      }
    }
  });
  pass("meshes", [&] {
    for (const auto& [name, mesh] : objects_.meshes()) {
      mesh_passes_.draw(*mesh, camera_view_, style);
    }
  });
}

void FrameDrawing::draw_picture(const Target& target, const RenderSettings& settings, bool linear) {
  DrawStyle style{DrawKind::kShaded, shadow_.texture(), kInk};
  if (!settings.wireframe) {
    const vec3 sky = settings.background.value_or(settings.sky_color);
    const vec3 clear = linear ? sky : vec3(encoded(sky.r), encoded(sky.g), encoded(sky.b));
    target.begin(clear.r, clear.g, clear.b);
    draw_all(style, settings.cull_back_faces, true);
    if (settings.snowfall.rate > 0.0f) {
      const auto measured = timer_.measure("flakes");
      flakes_.draw(settings.snowfall, camera_view_);
    }
    return;
  }
  target.begin(1.0f, 1.0f, 1.0f);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.0f, 1.0f);
  style.kind = DrawKind::kWire;
  style.wire_color = kPaper;
  draw_all(style, settings.cull_back_faces, false);
  glDisable(GL_POLYGON_OFFSET_FILL);
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  style.wire_color = kInk;
  draw_all(style, settings.cull_back_faces, true);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

void FrameDrawing::draw_frame(const Camera& camera, const RenderSettings& settings,
                              const Target& target, KeptTarget& large, bool linear,
                              Shadows shadows) {
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
  const ShadowInputs inputs{objects_.revision(),
                            settings.shadow_resolution,
                            view.shadow_from_world,
                            vec3(view.eye),
                            view.eye.w / view.tessellation.z,
                            view.eye.w / view.tessellation.w,
                            view.tessellation.y,
                            view.thesis};
  if (shadow_.is_outdated(inputs, shadows, settings.draft)) {
    shadow_.begin(inputs);
    draw_shadows(settings);
  }
  if (settings.antialias) {
    const Target& twice = large.of_size(of_pixels.width, of_pixels.height);
    draw_picture(twice, settings, linear);
    halve(twice, target);
  } else {
    draw_picture(target, settings, linear);
  }
}

Picture FrameDrawing::render(const Camera& camera, const RenderSettings& settings) {
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
  count_all_patches();
  return made;
}

const gpu::Texture& FrameDrawing::draw_light(const Camera& camera, const RenderSettings& settings,
                                             Shadows shadows) {
  const Target& picture = light_.of_size(camera.width, camera.height);
  timer_.set_enabled(false);
  draw_frame(camera, settings, picture, large_light_, true, shadows);
  timer_.set_enabled(true);
  return picture.color;
}

LightPicture FrameDrawing::render_light(const Camera& camera, const RenderSettings& settings,
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

DepthPicture FrameDrawing::render_depth(const Camera& camera, const RenderSettings& settings) {
  const Target& target = picture_.of_size(camera.width, camera.height);
  timer_.set_enabled(false);
  {
    const DrawState state;
    glBindVertexArray(no_vertices_.id());
    write_views(camera, settings, false);
    prepare_trees(settings);
    target.begin(0.0f, 0.0f, 0.0f);
    draw_all({DrawKind::kDepth, nullptr, kInk}, settings.cull_back_faces, false);
  }
  timer_.set_enabled(true);
  DepthPicture made{camera.width, camera.height, {}};
  made.depth.resize(static_cast<size_t>(camera.width) * camera.height);
  target.depth.read(0, GL_DEPTH_COMPONENT, GL_FLOAT,
                    static_cast<int64_t>(made.depth.size() * sizeof(float)), made.depth.data());
  return made;
}

FrameStatistics FrameDrawing::statistics() const {
  if (!statistics_) throw std::runtime_error("statistics: render a picture first");
  return *statistics_;
}

TreeLevels FrameDrawing::levels(const std::string& name) const {
  const SceneTree& of = objects_.tree(name);
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

void FrameDrawing::count_all_patches() {
  const auto add = [&](const PatchCounts& counts) {
    statistics_->dropped += counts.dropped;
    statistics_->plain += counts.plain;
    statistics_->tessellated += counts.tessellated;
  };
  for (const auto& [name, of] : objects_.trees()) {
    add(passes_.patches.count(of->buffers.camera));
  }
}

std::vector<vec3> FrameDrawing::captured(PatchPasses& passes, PatchSource& of,
                                         const gpu::Buffer& view, float max_level) {
  PatchList& list = of.camera;
  passes.classify(of, list, view, max_level);
  const auto style = [](DrawKind kind) { return DrawStyle{kind, nullptr, kInk}; };
  timer_.take();
  {
    const auto counted = timer_.measure("count");
    passes.draw_plain(of, list, view, style(DrawKind::kDepth));
    passes.draw_tessellated(of, list, view, style(DrawKind::kDepth));
  }
  const uint64_t count = timer_.take()[0].primitives;
  const gpu::Buffer positions(static_cast<int64_t>(3 * count * sizeof(vec3)));
  const auto plain_corners = list.commands.read_all<shared::TreeDrawCommand>()[0].count;
  const auto split = static_cast<int64_t>(plain_corners * sizeof(vec3));
  const auto into = [&](int64_t offset, int64_t bytes, auto&& draw) {
    if (bytes == 0) return;
    glBindBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, 0, positions.id(), offset, bytes);
    draw();
  };
  into(0, split, [&] { passes.draw_plain(of, list, view, style(DrawKind::kCapture)); });
  into(split, positions.bytes() - split,
       [&] { passes.draw_tessellated(of, list, view, style(DrawKind::kCapture)); });
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
  return positions.read_all<vec3>();
}

std::vector<vec3> FrameDrawing::triangles(const std::string& name, const Camera& camera,
                                          const RenderSettings& settings) {
  SceneTree& of = objects_.tree(name);
  const DrawState state;
  glBindVertexArray(no_vertices_.id());
  // Draws need a framebuffer even if they write only to transform feedback.
  nothing_.of_size(1, 1).begin(0.0f, 0.0f, 0.0f);
  glEnable(GL_RASTERIZER_DISCARD);
  write_views(camera, settings, false);
  passes_.pose(of.buffers, of.camera_view);
  passes_.edge_levels(of.buffers, of.camera_view);
  return captured(passes_.patches, of.buffers, of.camera_view, settings.max_level);
}

}  // namespace snowbough::render
