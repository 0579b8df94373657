#include "render/renderer.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "render/frame_drawing.h"

namespace snowbough::render {

struct Renderer::Drawing {
  // Created and destroyed on the GPU thread, in this order.
  std::optional<SceneObjects> objects;
  std::optional<FrameDrawing> frames;
  std::optional<FrameReader> reader;

  void make() {
    const int32_t blocks = gpu::storage_blocks();
    if (blocks < kStorageBlocks) {
      throw std::runtime_error("the OpenGL driver has " + std::to_string(blocks) +
                               " storage blocks in a stage of a shader, and drawing needs " +
                               std::to_string(kStorageBlocks) + ": update the driver");
    }
    objects.emplace();
    frames.emplace(*objects);
    reader.emplace();
  }
  /// @throws std::runtime_error if the creation failed.
  void require_made() const {
    if (!reader) throw std::runtime_error("the renderer was not created: see the previous error");
  }
  SceneObjects& made_objects() {
    require_made();
    return *objects;
  }
  FrameDrawing& made_frames() {
    require_made();
    return *frames;
  }
  void destroy() {
    reader.reset();
    frames.reset();
    objects.reset();
  }
};

Renderer::Renderer(const std::string& device, bool waits)
    : waits_(waits),
      thread_(waits ? gpu::GpuThread::shared(device) : gpu::GpuThread::begin(device)),
      drawing_(std::make_unique<Drawing>()) {
  if (waits) {
    thread_->run([&] { drawing_->make(); });
  } else {
    thread_->post([made = drawing_.get()] { made->make(); },
                  [this](const std::exception_ptr& error) { queue_.fail(error); });
  }
}

Renderer::~Renderer() {
  close();
}

void Renderer::close() {
  if (thread_ == nullptr) return;
  if (!thread_->is_in_this_process()) {
    static_cast<void>(drawing_.release());
    thread_.reset();
    return;
  }
  try {
    // Runs after all earlier work, so that no earlier work finds the scene destroyed.
    thread_->run([&] { drawing_->destroy(); });
  } catch (const std::exception&) {
    // The context was never created, so there is nothing to destroy.
  }
  drawing_.reset();
  thread_.reset();
}

Renderer::Drawing& Renderer::drawing() const {
  if (drawing_ == nullptr) throw std::runtime_error("the renderer is closed: make a new one");
  return *drawing_;
}

void Renderer::change(std::function<void(SceneObjects&)> work) {
  Drawing& of = drawing();
  if (waits_) {
    thread_->run([&] { work(of.made_objects()); });
    return;
  }
  thread_->post([&of, work = std::move(work)] { work(of.made_objects()); },
                [this](const std::exception_ptr& error) { queue_.fail(error); });
}

void Renderer::add_tree(const std::string& name, const TreeSource& source, const TreeLook& look) {
  drawing();
  change([name, look, patches = make_tree_patches(source, look.bark_depth)](SceneObjects& objects) {
    objects.add_tree(name, patches, look);
  });
}

void Renderer::share_tree(const std::string& name, const std::string& tree) {
  change([name, tree](SceneObjects& objects) { objects.share_tree(name, tree); });
}

void Renderer::set_leaves(const std::string& tree, const LeafSource& leaves) {
  change([tree, leaves](SceneObjects& objects) { objects.set_leaves(tree, leaves); });
}

void Renderer::set_bark(const std::string& tree, const BarkSource& bark) {
  change([tree, bark](SceneObjects& objects) { objects.set_bark(tree, bark); });
}

void Renderer::set_pose(const std::string& tree, const std::vector<glm::mat4>& matrices) {
  change([tree, matrices](SceneObjects& objects) { objects.set_pose(tree, matrices); });
}

void Renderer::add_mesh(const std::string& name, const MeshSource& source) {
  change([name, source](SceneObjects& objects) { objects.add_mesh(name, source); });
}

void Renderer::set_instances(const std::string& name, const std::vector<glm::mat4>& matrices) {
  change([name, matrices](SceneObjects& objects) { objects.set_instances(name, matrices); });
}

void Renderer::set_mesh_snow(const std::string& mesh, const MeshSnow& snow) {
  change([mesh, snow](SceneObjects& objects) { objects.set_mesh_snow(mesh, snow); });
}

void Renderer::set_snow(const std::string& tree, const TreeSnow& snow) {
  const bool is_whole =
      snow.width > 0 && snow.height > 0 &&
      snow.values.size() == static_cast<size_t>(snow.width) * static_cast<size_t>(snow.height);
  if (!is_whole || std::max(snow.width, snow.height) > 16384) {
    throw std::invalid_argument(
        "set_snow: a map must have height x width values and sides from 1 to 16384");
  }
  check(snow.look);
  change([tree, snow](SceneObjects& objects) { objects.set_snow(tree, snow); });
}

bool Renderer::share_snow(const std::string& tree, const gpu::ThreadTexture& heights,
                          const SnowLook& look) {
  check(look);
  Drawing& to = drawing();
  if (heights.thread != thread_) return false;
  thread_->run([&] { to.made_objects().share_snow(tree, *heights.texture, look); });
  return true;
}

void Renderer::remove(const std::string& name) {
  change([name](SceneObjects& objects) { objects.remove(name); });
}

Picture Renderer::render(const Camera& camera, const RenderSettings& settings) {
  check(camera, settings);
  flake_fall(settings.snowfall);
  Drawing& of = drawing();
  return thread_->run([&] { return of.made_frames().render(camera, settings); });
}

LightPicture Renderer::render_light(const Camera& camera, const RenderSettings& settings,
                                    int32_t samples) {
  check(camera, settings);
  if (samples < 1 || samples > 4096) {
    throw std::invalid_argument("samples must be from 1 to 4096, not " + std::to_string(samples));
  }
  Drawing& of = drawing();
  return thread_->run([&] { return of.made_frames().render_light(camera, settings, samples); });
}

DepthPicture Renderer::render_depth(const Camera& camera, const RenderSettings& settings) {
  check(camera, settings);
  Drawing& of = drawing();
  return thread_->run([&] { return of.made_frames().render_depth(camera, settings); });
}

uint64_t Renderer::request_frame(const Camera& camera, const RenderSettings& settings) {
  check(camera, settings);
  drawing();
  const uint64_t ticket = queue_.request(camera, settings);
  post_pump();
  return ticket;
}

std::optional<PackedFrame> Renderer::take_frame() {
  drawing();
  // Throws if there is no context: posted work never runs then.
  if (thread_->is_ready()) thread_->info();
  std::optional<PackedFrame> frame = queue_.take();
  if (queue_.is_busy()) post_pump();
  return frame;
}

void Renderer::post_pump() {
  if (!queue_.claim_pump()) return;
  Drawing& of = drawing();
  thread_->post(
      [this, &of] {
        of.require_made();
        queue_.pump(*of.reader, [&](const FrameQueue::Request& asked) -> const gpu::Texture& {
          return of.made_frames().draw_light(asked.camera, asked.settings);
        });
      },
      [this](const std::exception_ptr& error) { queue_.fail(error); });
}

bool Renderer::is_busy() const {
  drawing();
  return queue_.is_busy();
}

bool Renderer::is_ready() const {
  drawing();
  return thread_->is_ready();
}

FrameStatistics Renderer::statistics() const {
  Drawing& of = drawing();
  return thread_->run([&] { return of.made_frames().statistics(); });
}

std::vector<glm::vec3> Renderer::triangles(const std::string& name, const Camera& camera,
                                           const RenderSettings& settings) {
  check(camera, settings);
  Drawing& of = drawing();
  return thread_->run([&] { return of.made_frames().triangles(name, camera, settings); });
}

TreeLevels Renderer::levels(const std::string& tree) const {
  Drawing& of = drawing();
  return thread_->run([&] { return of.made_frames().levels(tree); });
}

const gpu::GpuInfo& Renderer::info() const {
  drawing();
  return thread_->info();
}

}  // namespace snowbough::render
