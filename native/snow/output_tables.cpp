#include "snow/output_tables.h"

#include <algorithm>
#include <exception>

namespace snowbough::snow {

void OutputTableStore::Entry::build() {
  std::call_once(once, [this] {
    const MapTopology& topology = receiver->description.topology;
    const std::vector<glm::vec3>& rest = receiver->description.rest;
    const TexelTable& table = receiver->table;
    tables.seams =
        build_seam_table(topology, table, {rest.begin(), rest.begin() + topology.vertex_count});
    tables.plan = plan_smoothing(table, tables.seams, static_cast<float>(blur_radius));
    if (on_processor) {
      tables.processor = std::make_unique<CpuOutput>(table, tables.seams, tables.plan);
    }
  });
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

std::shared_ptr<OutputTableStore::Entry> OutputTableStore::entry(const SceneObject& receiver,
                                                                 double blur_radius,
                                                                 bool on_processor) {
  std::shared_ptr<Entry>& known = entries_[receiver.description.name];
  if (known == nullptr) {
    known = std::make_shared<Entry>();
    known->receiver = &receiver;
    known->blur_radius = blur_radius;
    known->on_processor = on_processor;
  }
  return known;
}

void OutputTableStore::begin(const SceneObject& receiver, double blur_radius, bool on_processor) {
  if (entries_.contains(receiver.description.name)) {
    return;
  }
  const std::shared_ptr<Entry> added = entry(receiver, blur_radius, on_processor);
  const size_t most_workers = std::max(std::thread::hardware_concurrency(), 1u);
  {
    const std::scoped_lock lock(mutex_);
    waiting_.push_back(added);
    if (idle_ < waiting_.size() && workers_.size() < most_workers) {
      workers_.emplace_back([this] { work(); });
    }
  }
  wake_.notify_one();
}

OutputTables& OutputTableStore::get(const SceneObject& receiver, double blur_radius,
                                    bool on_processor) {
  const std::shared_ptr<Entry> wanted = entry(receiver, blur_radius, on_processor);
  wanted->build();
  return wanted->tables;
}

void OutputTableStore::forget(const std::string& name) {
  const auto found = entries_.find(name);
  if (found == entries_.end()) {
    return;
  }
  std::unique_lock lock(mutex_);
  const auto queued = std::find(waiting_.begin(), waiting_.end(), found->second);
  if (queued != waiting_.end()) {
    waiting_.erase(queued);
  } else if (found->second->taken) {
    finished_.wait(lock, [&] { return found->second->finished; });
  }
  entries_.erase(found);
}

void OutputTableStore::clear() {
  while (!entries_.empty()) {
    forget(entries_.begin()->first);
  }
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
    const std::shared_ptr<Entry> next = waiting_.front();
    waiting_.pop_front();
    next->taken = true;
    lock.unlock();
    try {
      next->build();
    } catch (const std::exception&) {
      // Whoever asks for the tables tries again and gets the exception.
    }
    lock.lock();
    next->finished = true;
    finished_.notify_all();
  }
}

}  // namespace snowbough::snow
