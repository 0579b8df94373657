#include "bindings.h"

namespace snowbough::python {

void bind_tree(pybind11::module_& module) { (void)module; }

}  // namespace snowbough::python
