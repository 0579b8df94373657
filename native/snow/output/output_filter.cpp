#include "snow/output/output_filter.h"

#include <algorithm>
#include <exception>
#include <glm/geometric.hpp>

namespace snowbough::snow {
namespace {

/// Unit normals; NaN for triangles without area.
std::vector<glm::vec3> triangle_normals(const MapTopology& topology,
                                        const std::vector<glm::vec3>& positions) {
  std::vector<glm::vec3> normals;
  normals.reserve(topology.triangles.size() / 3);
  for (size_t t = 0; t + 2 < topology.triangles.size(); t += 3) {
    const glm::vec3& first = positions[topology.triangles[t]];
    normals.push_back(glm::normalize(glm::cross(positions[topology.triangles[t + 1]] - first,
                                                positions[topology.triangles[t + 2]] - first)));
  }
  return normals;
}

}  // namespace

OutputFilter::OutputFilter(std::shared_ptr<const SceneObject> receiver, double blur_radius)
    : receiver_(std::move(receiver)), blur_radius_(blur_radius) {}

void OutputFilter::build() {
  std::call_once(built_, [this] {
    const MapTopology& topology = receiver_->description.topology;
    const std::vector<glm::vec3>& rest = receiver_->description.rest;
    seams_ = build_seam_table(topology, receiver_->table,
                              {rest.begin(), rest.begin() + topology.vertex_count});
    cpu_filter_ = std::make_unique<CpuFilter>(receiver_->table, seams_,
                                              SmoothingSettings{static_cast<float>(blur_radius_)},
                                              triangle_normals(topology, rest));
  });
}

const SeamTable& OutputFilter::seams() {
  build();
  return seams_;
}

MapOutput OutputFilter::run(std::vector<float> stored, const OutputSurface& surface) {
  build();
  return cpu_filter_->run(std::move(stored), surface);
}

OutputFilterCache::~OutputFilterCache() {
  clear();
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& worker : workers_) {
    worker.join();
  }
}

std::shared_ptr<OutputFilter> OutputFilterCache::get(
    const std::shared_ptr<const SceneObject>& receiver, double blur_radius) {
  std::shared_ptr<OutputFilter>& known = filters_[receiver->description.name];
  if (known == nullptr) {
    known = std::make_shared<OutputFilter>(receiver, blur_radius);
  }
  return known;
}

void OutputFilterCache::begin(const std::shared_ptr<const SceneObject>& receiver,
                              double blur_radius) {
  if (filters_.contains(receiver->description.name)) {
    return;
  }
  const size_t most_workers = std::max(std::thread::hardware_concurrency(), 1u);
  {
    const std::scoped_lock lock(mutex_);
    waiting_.push_back(get(receiver, blur_radius));
    if (idle_ < waiting_.size() && workers_.size() < most_workers) {
      workers_.emplace_back([this] { work(); });
    }
  }
  wake_.notify_one();
}

void OutputFilterCache::forget(const std::string& name) {
  const auto found = filters_.find(name);
  if (found == filters_.end()) {
    return;
  }
  const std::scoped_lock lock(mutex_);
  std::erase(waiting_, found->second);
  filters_.erase(found);
}

void OutputFilterCache::clear() {
  const std::scoped_lock lock(mutex_);
  waiting_.clear();
  filters_.clear();
}

void OutputFilterCache::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    ++idle_;
    wake_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
    --idle_;
    if (stopping_) {
      return;
    }
    const std::shared_ptr<OutputFilter> next = waiting_.front();
    waiting_.pop_front();
    lock.unlock();
    try {
      next->build();
    } catch (const std::exception&) {
      // The next caller of the filter tries again and gets the exception.
    }
    lock.lock();
  }
}

}  // namespace snowbough::snow
