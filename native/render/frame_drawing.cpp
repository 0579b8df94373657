#include "render/frame_drawing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>

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
  const shared::TreeView view = camera_view(camera, settings, around, linear);
  const auto write = [](gpu::Buffer& buffer, const shared::TreeView& its) {
    buffer.write(0, sizeof its, &its);
  };
  write(camera_view_, view);
  write(sun_view_, sun_view(view));
  return view;
}

void FrameDrawing::prepare_trees(const shared::TreeView& view, const RenderSettings& settings,
                                 bool shadows) {
  const auto each = [&](const char* pass, auto&& work) {
    const auto measured = timer_.measure(pass);
    for (TreeChain& chain : forest_.chains()) work(chain);
  };
  objects_.tree_data().snow.find_depths();
  const shared::TreeView sun = sun_view(view);
  forest_.gather(objects_.drawn_trees(), objects_.tree_data(), view, shadows ? &sun : nullptr);
  each("pose", [&](TreeChain& chain) { passes_.pose(chain, camera_view_); });
  each("edges", [&](TreeChain& chain) { passes_.edge_levels(chain, camera_view_); });
  each("classify", [&](TreeChain& chain) {
    passes_.classify(chain, chain.camera.bark, camera_view_, settings.max_level);
    leaf_passes_.classify(chain, chain.camera.leaves, camera_view_);
  });
}

void FrameDrawing::draw_shadows(const RenderSettings& settings) {
  if (settings.shadow_resolution == 0) return;
  const auto measured = timer_.measure("shadow");
  glDisable(GL_CULL_FACE);
  const DrawStyle style{DrawKind::kDepth, shadow_.texture(), kInk};
  for (TreeChain& chain : forest_.chains()) {
    const TreeLists& sun = chain.sun;
    passes_.classify(chain, chain.sun.bark, sun_view_, settings.max_level);
    leaf_passes_.classify(chain, chain.sun.leaves, sun_view_);
    passes_.draw_plain(chain, sun.bark, sun_view_, style);
    passes_.draw_tessellated(chain, sun.bark, sun_view_, style);
    leaf_passes_.draw(chain, sun.leaves, sun_view_, style);
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
    for (const TreeChain& chain : forest_.chains()) {
      passes_.draw_plain(chain, chain.camera.bark, camera_view_, style);
    }
  });
  pass("tessellated", [&] {
    for (const TreeChain& chain : forest_.chains()) {
      passes_.draw_tessellated(chain, chain.camera.bark, camera_view_, style);
    }
  });
  glDisable(GL_CULL_FACE);
  pass("leaves", [&] {
    for (const TreeChain& chain : forest_.chains()) {
      leaf_passes_.draw(chain, chain.camera.leaves, camera_view_, style);
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
                              const Target& target, ReusedTarget& large, bool linear,
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
  const ShadowInputs inputs{objects_.revision(),
                            settings.shadow_resolution,
                            view.shadow_from_world,
                            vec3(view.eye),
                            view.eye.w / view.tessellation.z,
                            view.eye.w / view.tessellation.w,
                            view.tessellation.y,
                            view.thesis};
  const bool draws_shadows = shadow_.is_outdated(inputs, shadows, settings.draft);
  prepare_trees(view, settings, draws_shadows && settings.shadow_resolution > 0);
  if (draws_shadows) {
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
  const gpu::CallCounts calls = gpu::call_counts();
  const Target& picture = picture_.of_size(camera.width, camera.height);
  draw_frame(camera, settings, picture, large_, false, Shadows::kDraw);
  Picture made{camera.width, camera.height, read_color(picture)};

  statistics_.emplace();
  statistics_->wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  const gpu::CallCounts now = gpu::call_counts();
  statistics_->calls = {now.dispatches - calls.dispatches, now.draws - calls.draws};
  statistics_->buffer_bytes = gpu::buffer_bytes();
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
    prepare_trees(write_views(camera, settings, false), settings, false);
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
  const TreeModel& model = *of.model();
  TreeLevels levels;
  levels.classes.resize(model.quads.size(), shared::kDropped);
  levels.edges.resize(model.quads.size(), {1.0f, 1.0f, 1.0f, 1.0f});
  for (const TreeChain& chain : forest_.chains()) {
    const auto found = std::find(chain.trees.begin(), chain.trees.end(), &of);
    if (found == chain.trees.end()) continue;
    const auto index = static_cast<int32_t>(found - chain.trees.begin());
    const auto edges = chain.edge_levels.read_all<float>();
    const auto first = static_cast<size_t>(chain.instances[static_cast<size_t>(index)].own.y);
    const auto needed = static_cast<size_t>(chain.edges.count_of(index));
    for (size_t patch = 0; patch < model.quads.size(); ++patch) {
      for (int k = 0; k < 4; ++k) {
        const auto edge = static_cast<size_t>(model.patch_edges[patch][k] >> 1);
        const auto quad = static_cast<size_t>(model.quads[patch]);
        if (edge < needed) levels.edges[quad][static_cast<size_t>(k)] = edges[first + edge];
      }
    }
    const auto classes = chain.camera.bark.classes().read_all<uint32_t>();
    for (const shared::WorkRange& range : chain.camera.bark.ranges()) {
      if (range.instance != index) continue;
      for (int32_t patch = 0; patch < range.count; ++patch) {
        levels.classes[static_cast<size_t>(model.quads[static_cast<size_t>(patch)])] =
            classes[static_cast<size_t>(range.first_slot + patch)];
      }
    }
    break;
  }
  return levels;
}

void FrameDrawing::count_all_patches() {
  for (const auto& [name, of] : objects_.trees()) {
    statistics_->dropped +=
        of->model()->patch_count() * static_cast<int64_t>(of->matrices().size());
  }
  for (const TreeChain& chain : forest_.chains()) {
    const PatchCounts counts = TreePasses::count(chain.camera.bark);
    statistics_->plain += counts.plain;
    statistics_->tessellated += counts.tessellated;
  }
  statistics_->dropped -= statistics_->plain + statistics_->tessellated;
}

std::vector<vec3> FrameDrawing::captured(TreeChain& chain, const RenderSettings& settings) {
  const PatchList& list = chain.camera.bark;
  passes_.pose(chain, camera_view_);
  passes_.edge_levels(chain, camera_view_);
  passes_.classify(chain, chain.camera.bark, camera_view_, settings.max_level);
  const auto style = [](DrawKind kind) { return DrawStyle{kind, nullptr, kInk}; };
  timer_.take();
  {
    const auto counted = timer_.measure("count");
    passes_.draw_plain(chain, list, camera_view_, style(DrawKind::kDepth));
    passes_.draw_tessellated(chain, list, camera_view_, style(DrawKind::kDepth));
  }
  const uint64_t count = timer_.take()[0].primitives;
  const gpu::Buffer positions(static_cast<int64_t>(3 * count * sizeof(vec3)));
  const auto plain = static_cast<size_t>(TreePasses::count(list).plain);
  const auto split = static_cast<int64_t>(6 * plain * sizeof(vec3));
  const auto into = [&](int64_t offset, int64_t bytes, auto&& draw) {
    if (bytes == 0) return;
    glBindBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, 0, positions.id(), offset, bytes);
    draw();
  };
  into(0, split, [&] { passes_.draw_plain(chain, list, camera_view_, style(DrawKind::kCapture)); });
  into(split, positions.bytes() - split,
       [&] { passes_.draw_tessellated(chain, list, camera_view_, style(DrawKind::kCapture)); });
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
  std::vector<vec3> corners = positions.read_all<vec3>();

  // Patches are listed in the order of order_patches.
  const auto listed = list.plain().read_all<glm::ivec2>();
  const std::vector<int32_t>& quads = chain.trees[0]->model()->quads;
  std::vector<std::tuple<int32_t, int32_t, size_t>> order;
  for (size_t i = 0; i < plain; ++i) {
    order.emplace_back(listed[i].x, quads[static_cast<size_t>(listed[i].y)], i);
  }
  std::sort(order.begin(), order.end());
  std::vector<vec3> sorted;
  for (const auto& [instance, quad, i] : order) {
    const auto from = corners.begin() + static_cast<int64_t>(6 * i);
    sorted.insert(sorted.end(), from, from + 6);
  }
  std::copy(sorted.begin(), sorted.end(), corners.begin());
  return corners;
}

std::vector<vec3> FrameDrawing::triangles(const std::string& name, const Camera& camera,
                                          const RenderSettings& settings) {
  const SceneTree& of = objects_.tree(name);
  const DrawState state;
  glBindVertexArray(no_vertices_.id());
  // Draws need a framebuffer even if they write only to transform feedback.
  nothing_.of_size(1, 1).begin(0.0f, 0.0f, 0.0f);
  glEnable(GL_RASTERIZER_DISCARD);
  const shared::TreeView view = write_views(camera, settings, false);
  objects_.tree_data().snow.find_depths();
  Forest alone(objects_.most_bytes());
  alone.gather({&of}, objects_.tree_data(), view, nullptr);
  std::vector<vec3> corners;
  for (TreeChain& chain : alone.chains()) {
    const std::vector<vec3> more = captured(chain, settings);
    corners.insert(corners.end(), more.begin(), more.end());
  }
  return corners;
}

}  // namespace snowbough::render
