#include "bindings.h"

namespace snowbough::python {

void bind_image(pybind11::module_& module) { (void)module; }

}  // namespace snowbough::python
