#include "snow/output_tables.h"

#include <algorithm>
#include <exception>
#include <glm/vec4.hpp>

#include "snow/dilate.h"

namespace snowbough::snow {

OutputTables::OutputTables(std::shared_ptr<const SceneObject> receiver, double blur_radius,
                           bool on_processor)
    : receiver_(std::move(receiver)), blur_radius_(blur_radius), on_processor_(on_processor) {}

void OutputTables::build() {
  std::call_once(built_, [this] {
    const MapTopology& topology = receiver_->description.topology;
    const std::vector<glm::vec3>& rest = receiver_->description.rest;
    seams_ = build_seam_table(topology, receiver_->table,
                              {rest.begin(), rest.begin() + topology.vertex_count});
    plan_ = plan_smoothing(receiver_->table, seams_, static_cast<float>(blur_radius_));
    if (on_processor_) {
      make_processor();
    } else {
      make_leveller();
    }
  });
}

void OutputTables::make_processor() {
  processor_ = std::make_unique<CpuOutput>(receiver_->table, seams_, plan_);
}

void OutputTables::make_leveller() {
  const bool is_smoothed = plan_.closing_passes > 0;
  leveller_ = std::make_unique<SeamLeveller>(is_smoothed ? seams_.levelling : SeamLevelling());
}

const SeamTable& OutputTables::seams() {
  build();
  return seams_;
}

const SmoothingPlan& OutputTables::plan() {
  build();
  return plan_;
}

MapOutput OutputTables::output_on_processor(std::vector<float> stored,
                                            const std::vector<SurfaceMetric>& metrics) {
  build();
  {
    const std::scoped_lock lock(making_);
    if (processor_ == nullptr) {
      make_processor();
    }
  }
  return processor_->run(std::move(stored), metrics);
}

MapOutput OutputTables::output_on_gpu(OutputPasses& passes, const gpu::Texture& height_maps,
                                      int32_t layer, const std::vector<SurfaceMetric>& metrics) {
  const TexelTable& table = receiver_->table;
  OutputBuffers buffers = make_output_buffers(table, seams(), plan());
  MapOutput output;
  passes.smoothing.run(height_maps, layer, buffers);
  output.height = buffers.map.read_all<float>();
  if (metrics.empty()) {
    return output;
  }
  level(output.height);
  buffers.map.write(0, buffers.map.bytes(), output.height.data());
  passes.normals.run(buffers, table, metrics);
  const auto values = buffers.normals.read_all<glm::vec4>();
  output.normal = dilate_normals(table, seams_, {values.begin(), values.end()});
  return output;
}

void OutputTables::level(std::vector<float>& map) {
  build();
  const std::scoped_lock lock(making_);
  if (leveller_ == nullptr) {
    make_leveller();
  }
  leveller_->run(map);
}

OutputTableStore::~OutputTableStore() {
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

std::shared_ptr<OutputTables> OutputTableStore::get(
    const std::shared_ptr<const SceneObject>& receiver, double blur_radius, bool on_processor) {
  std::shared_ptr<OutputTables>& known = tables_[receiver->description.name];
  if (known == nullptr) {
    known = std::make_shared<OutputTables>(receiver, blur_radius, on_processor);
  }
  return known;
}

void OutputTableStore::begin(const std::shared_ptr<const SceneObject>& receiver, double blur_radius,
                             bool on_processor) {
  if (tables_.contains(receiver->description.name)) {
    return;
  }
  const size_t most_workers = std::max(std::thread::hardware_concurrency(), 1u);
  {
    const std::scoped_lock lock(mutex_);
    waiting_.push_back(get(receiver, blur_radius, on_processor));
    if (idle_ < waiting_.size() && workers_.size() < most_workers) {
      workers_.emplace_back([this] { work(); });
    }
  }
  wake_.notify_one();
}

void OutputTableStore::forget(const std::string& name) {
  const auto found = tables_.find(name);
  if (found == tables_.end()) {
    return;
  }
  const std::scoped_lock lock(mutex_);
  std::erase(waiting_, found->second);
  tables_.erase(found);
}

void OutputTableStore::clear() {
  const std::scoped_lock lock(mutex_);
  waiting_.clear();
  tables_.clear();
}

void OutputTableStore::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    ++idle_;
    wake_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
    --idle_;
    if (stopping_) {
      return;
    }
    const std::shared_ptr<OutputTables> next = waiting_.front();
    waiting_.pop_front();
    lock.unlock();
    try {
      next->build();
    } catch (const std::exception&) {
      // Whoever asks for the tables tries again and gets the exception.
    }
    lock.lock();
  }
}

}  // namespace snowbough::snow
