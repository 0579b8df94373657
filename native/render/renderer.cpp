#include "render/renderer.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "render/scene.h"

namespace snowbough::render {

Renderer::Renderer(const std::string& device) : thread_(gpu::GpuThread::shared(device)) {
  scene_ = thread_->run([] { return std::make_unique<Scene>(); });
}

Renderer::~Renderer() {
  close();
}

void Renderer::close() {
  if (thread_ == nullptr) return;
  thread_->run([&] { scene_.reset(); });
  thread_.reset();
}

Scene& Renderer::scene() const {
  if (scene_ == nullptr) throw std::runtime_error("the renderer is closed: make a new one");
  return *scene_;
}

void Renderer::add_tree(const std::string& name, const TreeSource& source, const TreeLook& look) {
  Scene& to = scene();
  const TreePatches patches = make_tree_patches(source, look.bark_depth);
  thread_->run([&] { to.add_tree(name, patches, look); });
}

void Renderer::set_leaves(const std::string& tree, const LeafSource& leaves) {
  Scene& to = scene();
  thread_->run([&] { to.set_leaves(tree, leaves); });
}

void Renderer::set_pose(const std::string& tree, const std::vector<glm::mat4>& matrices) {
  Scene& to = scene();
  thread_->run([&] { to.set_pose(tree, matrices); });
}

void Renderer::add_mesh(const std::string& name, const MeshSource& source) {
  Scene& to = scene();
  thread_->run([&] { to.add_mesh(name, source); });
}

void Renderer::add_snow_mesh(const std::string& name, const SnowSource& source) {
  Scene& to = scene();
  SnowMesh mesh(source);
  thread_->run([&] { to.add_snow_mesh(name, std::move(mesh), source.color); });
}

void Renderer::set_snow_pose(const std::string& mesh, const std::vector<glm::vec3>& positions,
                             const std::vector<std::array<glm::vec3, 3>>& normals) {
  Scene& of = scene();
  thread_->run([&] { of.set_snow_pose(mesh, positions, normals); });
}

void Renderer::set_snow(const std::string& mesh, const HeightMap& heights) {
  Scene& to = scene();
  const bool is_whole = heights.width > 0 && heights.height > 0 &&
                        heights.values.size() == static_cast<size_t>(heights.width) *
                                                     static_cast<size_t>(heights.height);
  if (!is_whole || std::max(heights.width, heights.height) > 16384) {
    throw std::invalid_argument(
        "set_snow: a map must have height x width values, 1 to 16384 a side");
  }
  thread_->run([&] { to.set_snow(mesh, heights); });
}

bool Renderer::share_snow(const std::string& mesh, const gpu::ThreadTexture& heights) {
  Scene& to = scene();
  if (heights.thread != thread_) return false;
  return thread_->run([&] { return to.share_snow(mesh, heights.texture); });
}

void Renderer::remove(const std::string& name) {
  Scene& from = scene();
  thread_->run([&] { from.remove(name); });
}

Picture Renderer::render(const Camera& camera, const RenderSettings& settings) {
  check(camera, settings);
  flake_fall(settings.snowfall);
  Scene& of = scene();
  return thread_->run([&] { return of.render(camera, settings); });
}

FrameStatistics Renderer::statistics() const {
  const Scene& of = scene();
  return thread_->run([&] { return of.statistics(); });
}

std::vector<glm::vec3> Renderer::triangles(const std::string& name, const Camera& camera,
                                           const RenderSettings& settings) {
  check(camera, settings);
  Scene& of = scene();
  return thread_->run([&] { return of.triangles(name, camera, settings); });
}

TreeLevels Renderer::levels(const std::string& tree) const {
  const Scene& of = scene();
  return thread_->run([&] { return of.levels(tree); });
}

SnowLevels Renderer::snow_levels(const std::string& mesh) const {
  const Scene& of = scene();
  return thread_->run([&] { return of.snow_levels(mesh); });
}

const gpu::GpuInfo& Renderer::info() const {
  scene();
  return thread_->info();
}

}  // namespace snowbough::render
