#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "bindings.h"

namespace {

[[noreturn]] void* refuse_unmade(size_t) {
  throw pybind11::type_error(
      R"(this object was not initialised: call its class, not __new__; it cannot be copied or
pickled)");
}

/// Makes every class of the module refuse objects created by `__new__` alone, as `copy` does:
/// pybind11 would use uninitialised memory.
void refuse_unmade_objects(const pybind11::module_& module) {
  for (const auto& [name, member] : module.attr("__dict__").cast<pybind11::dict>()) {
    if (!PyType_Check(member.ptr())) continue;
    auto* type = reinterpret_cast<PyTypeObject*>(member.ptr());
    if (auto* info = pybind11::detail::get_type_info(type)) info->operator_new = &refuse_unmade;
  }
}

}  // namespace

// One bind function per topic.
PYBIND11_MODULE(SNOWBOUGH_MODULE, module) {
  module.doc() =
      R"(Snowbough's native core: trees from OBJ files, and snow that accumulates on moving objects.)";
  module.attr("__version__") = SNOWBOUGH_VERSION;
  // pybind11 imports NumPy when the first array is created and releases the GIL meanwhile: a second
  // thread that also creates its first array would deadlock with it.
  pybind11::dtype::of<float>();
  snowbough::python::bind_skeleton(module);
  snowbough::python::bind_tree(module);
  snowbough::python::bind_tree_uvs(module);
  snowbough::python::bind_kept(module);
  snowbough::python::bind_engine(module);
  snowbough::python::bind_snow(module);
  snowbough::python::bind_snow_state(module);
  snowbough::python::bind_surface(module);
  snowbough::python::bind_render(module);
  snowbough::python::bind_image(module);
  snowbough::python::bind_maps(module);
  refuse_unmade_objects(module);
}
