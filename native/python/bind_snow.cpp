#include "bindings.h"

namespace snowbough::python {

void bind_snow(pybind11::module_& module) { (void)module; }

}  // namespace snowbough::python
