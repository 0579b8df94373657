#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "bindings.h"

namespace {

[[noreturn]] void* refuse_unmade(size_t) {
  throw pybind11::type_error(
      "the object was never made: call its class, not __new__; it cannot be copied or pickled");
}

/// Lets every class of the module refuse objects that come from `__new__` alone, as `copy` makes
/// them: pybind11 would hand out memory that no constructor has seen.
void refuse_unmade_objects(const pybind11::module_& module) {
  for (const auto& [name, member] : module.attr("__dict__").cast<pybind11::dict>()) {
    if (!PyType_Check(member.ptr())) continue;
    auto* type = reinterpret_cast<PyTypeObject*>(member.ptr());
    if (auto* info = pybind11::detail::get_type_info(type)) info->operator_new = &refuse_unmade;
  }
}

}  // namespace

// The table of contents: one bind function a topic.
PYBIND11_MODULE(SNOWBOUGH_MODULE, module) {
  module.doc() = "Snowbough's native core: trees from OBJ, and snow that stays where it fell.";
  module.attr("__version__") = SNOWBOUGH_VERSION;
  // pybind11 looks NumPy up when the first array is made and lets other threads run meanwhile: one
  // that made its first array as well would wait for the first thread, and that one for its turn,
  // for ever.
  pybind11::dtype::of<float>();
  snowbough::python::bind_skeleton(module);
  snowbough::python::bind_tree(module);
  snowbough::python::bind_tree_uvs(module);
  snowbough::python::bind_gpu(module);
  snowbough::python::bind_engine(module);
  snowbough::python::bind_snow(module);
  snowbough::python::bind_snow_state(module);
  snowbough::python::bind_surface(module);
  snowbough::python::bind_render(module);
  snowbough::python::bind_image(module);
  snowbough::python::bind_maps(module);
  refuse_unmade_objects(module);
}
