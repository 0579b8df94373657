#include "snow/output/output_filter.h"

#include <exception>

#include "base/thread_pool.h"

namespace snowbough::snow {
OutputFilter::OutputFilter(std::shared_ptr<const SceneObject> receiver, double blur_radius)
    : receiver_(std::move(receiver)), blur_radius_(blur_radius) {}

void OutputFilter::build() {
  std::call_once(built_, [this] {
    const MapTopology& topology = receiver_->description.topology;
    const std::vector<glm::vec3>& rest = receiver_->description.rest;
    seams_ = build_seam_table(topology, *receiver_->table,
                              {rest.begin(), rest.begin() + topology.vertex_count});
    cpu_filter_ = std::make_unique<CpuFilter>(*receiver_->table, seams_,
                                              SmoothingSettings{static_cast<float>(blur_radius_)});
  });
}

const SeamTable& OutputFilter::seams() {
  build();
  return seams_;
}

MapOutput OutputFilter::run(std::vector<float> stored, const OutputPose& pose) {
  build();
  return cpu_filter_->run(std::move(stored), pose);
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
  if (filters_.contains(receiver->description.name)) return;
  const std::weak_ptr<OutputFilter> filter = get(receiver, blur_radius);
  base::ThreadPool::shared().begin([filter] {
    const std::shared_ptr<OutputFilter> known = filter.lock();
    if (known == nullptr) return;  // forgotten before its turn
    try {
      known->build();
    } catch (const std::exception&) {
      // The next caller of the filter tries again and gets the exception.
    }
  });
}

}  // namespace snowbough::snow
