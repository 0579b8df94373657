#include <memory>
#include <stdexcept>

#include "base/thread_pool.h"
#include "engine_arguments.h"
#include "python/bindings.h"
#include "snow/step/choose_engine.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

/// Keeps an engine, and the driver that it has loaded, until closed.
class HeldEngine {
 public:
  HeldEngine(const std::string& engine, const std::string& mapping, const std::string& device) {
    const snow::EngineRequest request{snow::engine_kind(engine), snow::deposit_mapping(mapping),
                                      device};
    const ReleasedGil release;
    base::start_thread_pool();
    choice_ = std::make_unique<snow::EngineChoice>(request);
  }
  HeldEngine(const HeldEngine&) = delete;
  HeldEngine& operator=(const HeldEngine&) = delete;

  py::dict info() {
    if (choice_ == nullptr) throw std::runtime_error("the engine is closed: make a new Engine");
    return engine_dict(without_gil([&]() -> snow::EngineInfo {
      const snow::Engine& engine = choice_->engine();
      return {snow::engine_name(engine.kind()), engine.driver(), choice_->reason()};
    }));
  }

  void close() {
    const ReleasedGil release;
    choice_.reset();
  }

 private:
  std::unique_ptr<snow::EngineChoice> choice_;
};

}  // namespace

py::dict engine_dict(const snow::EngineInfo& info) {
  py::dict dict;
  dict["name"] = info.name;
  dict["driver"] = info.driver;
  dict["reason"] = info.reason;
  return dict;
}

void bind_engine(py::module_& module) {
  using namespace py::literals;
  py::class_<HeldEngine, HeldWithoutGil<HeldEngine>>(
      module, "Engine",
      R"(Holds the engine that a simulation with these arguments would have (see SnowSimulation):
simulations created meanwhile share its driver. A context manager: leaving it releases the engine.)")
      .def(py::init<const std::string&, const std::string&, const std::string&>(),
           "engine"_a = "AUTO", "mapping"_a = "COMPUTE", "device"_a = "")
      .def_property_readonly(
          "info", &HeldEngine::info,
          R"(As SnowSimulation.engine. Raises RuntimeError with advice if GL is requested and no
OpenGL 4.5 context can be created.)")
      .def("close", &HeldEngine::close, "Releases the engine.")
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](HeldEngine& self, const py::args&) { self.close(); });
}

}  // namespace snowbough::python
