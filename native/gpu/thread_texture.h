#pragma once

#include <memory>

#include "gpu/gpu_thread.h"
#include "gpu/resources.h"

namespace snowbough::gpu {

/// A texture and the thread of its context, the only thread that can draw from it. Can be released
/// on any thread.
struct ThreadTexture {
  std::shared_ptr<GpuThread> thread;
  std::shared_ptr<const Texture> texture;
};

/// Wraps a texture whose last owner may be on another thread.
inline ThreadTexture share_texture(const std::shared_ptr<GpuThread>& thread, Texture&& texture) {
  const auto release = [thread](const Texture* last) { thread->run([last] { delete last; }); };
  return {thread, std::shared_ptr<const Texture>(new Texture(std::move(texture)), release)};
}

}  // namespace snowbough::gpu
