#include <pybind11/stl.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/thread_pool.h"
#include "bindings.h"
#include "gpu/gpu_thread.h"
#include "gpu/shader_source.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

/// Keeps the process's thread for a device, and its context, until closed.
class HeldGpu {
 public:
  explicit HeldGpu(const std::string& device) {
    const ReleasedGil release;
    base::start_thread_pool();
    thread_ = gpu::GpuThread::begin(device);
  }
  HeldGpu(const HeldGpu&) = delete;
  HeldGpu& operator=(const HeldGpu&) = delete;

  gpu::GpuInfo info() const {
    const std::shared_ptr<gpu::GpuThread> thread = thread_;
    if (thread == nullptr) {
      throw std::runtime_error("the GPU is closed: make a new Gpu");
    }
    const ReleasedGil release;
    return thread->info();
  }

  void close() {
    std::shared_ptr<gpu::GpuThread> thread = std::move(thread_);
    const ReleasedGil release;
    thread.reset();
  }

 private:
  std::shared_ptr<gpu::GpuThread> thread_;
};

py::dict info_dict(const HeldGpu& gpu) {
  const gpu::GpuInfo info = gpu.info();
  py::dict dict;
  dict["vendor"] = info.vendor;
  dict["renderer"] = info.renderer;
  dict["version"] = info.version;
  dict["device"] = info.device;
  dict["max_texture_size"] = info.max_texture_size;
  dict["max_array_layers"] = info.max_array_layers;
  dict["max_viewport"] = info.max_viewport;
  dict["max_storage_buffer_bytes"] = info.max_storage_buffer_bytes;
  return dict;
}

}  // namespace

void bind_gpu(py::module_& module) {
  using namespace py::literals;
  py::class_<HeldGpu, HeldWithoutGil<HeldGpu>>(
      module, "Gpu",
      R"(Holds the GPU context of the simulations: those created meanwhile share it instead of
creating their own. Returns while the context is still being created. A context manager: leaving it
releases the context.)")
      .def(py::init<const std::string&>(), "device"_a = "")
      .def_property_readonly(
          "info", &info_dict,
          R"(Vendor, renderer, version and limits, as a dict. Raises RuntimeError with advice if no
OpenGL 4.5 context can be created.)")
      .def("close", &HeldGpu::close, "Releases the context, which ends with its last simulation.")
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](HeldGpu& self, const py::args&) { self.close(); });

  module.def(
      "gpu_info", [](const std::string& device) { return info_dict(HeldGpu(device)); },
      "device"_a = "",
      R"(Vendor, renderer, version and limits of the simulations' GPU, as a dict. Raises as
Gpu.info.)");

  module.def(
      "shader_source", &gpu::shader_source, "name"_a, "defines"_a = std::vector<std::string>{},
      R"(A shader's source for the GL compiler: its #version, a #define for each of defines ('NAME'
or 'NAME value'), and its text with all includes inserted. Needs no GPU. Raises RuntimeError naming
a file that does not exist.)");
}

}  // namespace snowbough::python
