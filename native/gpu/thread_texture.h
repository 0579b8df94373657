#pragma once

#include <memory>

#include "gpu/gpu_thread.h"
#include "gpu/resources.h"

namespace snowbough::gpu {

/// A texture that is handed from one owner to another, with the thread of its context: only there
/// can it be drawn from. May be let go of on any thread.
struct ThreadTexture {
  std::shared_ptr<GpuThread> thread;
  std::shared_ptr<const Texture> texture;
};

/// Keeps a texture whose last owner may be on another thread.
inline ThreadTexture share_texture(const std::shared_ptr<GpuThread>& thread, Texture&& texture) {
  const auto let_go = [thread](const Texture* last) { thread->run([last] { delete last; }); };
  return {thread, std::shared_ptr<const Texture>(new Texture(std::move(texture)), let_go)};
}

}  // namespace snowbough::gpu
