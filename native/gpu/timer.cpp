#include "gpu/timer.h"

#include <stdexcept>
#include <utility>

namespace snowbough::gpu {

Query::Query(GLenum target) {
  glCreateQueries(target, 1, &id_);
}

Query::~Query() {
  if (id_ != 0) {
    glDeleteQueries(1, &id_);
  }
}

uint64_t Query::result() const {
  GLuint64 value = 0;
  glGetQueryObjectui64v(id_, GL_QUERY_RESULT, &value);
  return value;
}

PassTimer::Pass PassTimer::measure(std::string name) {
  if (!enabled_) return Pass(*this);
  if (running_) {
    throw std::logic_error("pass '" + name + "' begins before '" + measurements_[used_].name +
                           "' has ended");
  }
  if (used_ == measurements_.size()) {
    measurements_.emplace_back();
  }
  Measurement& measurement = measurements_[used_];
  measurement.name = std::move(name);
  measurement.started = Clock::now();
  glQueryCounter(measurement.begin.id(), GL_TIMESTAMP);
  glBeginQuery(GL_PRIMITIVES_GENERATED, measurement.primitives.id());
  running_ = true;
  return Pass(*this);
}

void PassTimer::end() {
  if (!running_) return;
  Measurement& measurement = measurements_[used_];
  glEndQuery(GL_PRIMITIVES_GENERATED);
  if (waits_) glFinish();
  glQueryCounter(measurement.end.id(), GL_TIMESTAMP);
  measurement.wall_seconds =
      std::chrono::duration<double>(Clock::now() - measurement.started).count();
  running_ = false;
  ++used_;
}

std::vector<PassTime> PassTimer::take() {
  if (running_) {
    throw std::logic_error("pass '" + measurements_[used_].name + "' has not ended");
  }
  std::vector<PassTime> times;
  for (size_t i = 0; i < used_; ++i) {
    const Measurement& measurement = measurements_[i];
    const uint64_t begin = measurement.begin.result();
    const uint64_t end = measurement.end.result();
    times.push_back({measurement.name, end > begin ? 1e-9 * static_cast<double>(end - begin) : 0.0,
                     measurement.wall_seconds, measurement.primitives.result()});
  }
  used_ = 0;
  return times;
}

}  // namespace snowbough::gpu
