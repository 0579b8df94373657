#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "bindings.h"

// The table of contents: one bind function a topic.
PYBIND11_MODULE(snowbough_native, module) {
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
}
