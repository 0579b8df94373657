#include <cstring>

#include "bindings.h"
#include "numpy_arrays.h"
#include "pybind11/stl.h"
#include "snow/simulation.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

using snow::SnowSimulation;

py::dict state_of(SnowSimulation& simulation) {
  snow::SimulationState state;
  {
    const py::gil_scoped_release release;
    state = simulation.state();
  }
  py::dict objects;
  for (snow::ObjectState& object : state.objects) {
    py::dict own;
    const py::ssize_t edge = object.resolution;
    own["height"] = to_numpy<float>(std::move(object.height), {edge, edge});
    own["sums"] =
        py::array_t<double>(static_cast<py::ssize_t>(object.sums.size()), object.sums.data());
    objects[py::str(object.name)] = own;
  }
  py::dict result;
  result["step_number"] = state.step_number;
  result["objects"] = objects;
  return result;
}

void set_state(SnowSimulation& simulation, const py::dict& given) {
  snow::SimulationState state;
  state.step_number = py::cast<uint32_t>(given["step_number"]);
  std::map<std::string, snow::ObjectState> sorted;
  for (const auto& [key, value] : py::cast<py::dict>(given["objects"])) {
    snow::ObjectState object;
    object.name = py::cast<std::string>(key);
    const auto own = py::cast<py::dict>(value);
    const auto height = py::cast<InputArray<float>>(own["height"]);
    const auto sums = py::cast<InputArray<double>>(own["sums"]);
    if (height.ndim() != 2 || height.shape(0) != height.shape(1)) {
      throw std::invalid_argument("state of '" + object.name + "': height must have shape (H, H)");
    }
    if (sums.size() != static_cast<py::ssize_t>(object.sums.size())) {
      throw std::invalid_argument("state of '" + object.name + "': sums must have " +
                                  std::to_string(object.sums.size()) + " values");
    }
    object.resolution = static_cast<int32_t>(height.shape(0));
    object.height.assign(height.data(), height.data() + height.size());
    std::memcpy(object.sums.data(), sums.data(), sizeof object.sums);
    std::string name = object.name;
    sorted.emplace(std::move(name), std::move(object));
  }
  for (auto& [name, object] : sorted) {
    state.objects.push_back(std::move(object));
  }
  const py::gil_scoped_release release;
  simulation.set_state(state);
}

}  // namespace

void bind_snow_state(py::module_& module) {
  using namespace py::literals;
  module.def("simulation_state", &state_of, "simulation"_a,
             "What a checkpoint of a SnowSimulation holds, as plain arrays: {'step_number': int,\n"
             "'objects': {receiver: {'height': (H, H) float32 metres, 'sums': (16,) float64}}}.");
  module.def(
      "set_simulation_state", &set_state, "simulation"_a, "state"_a,
      "Takes a state of simulation_state, for a simulation with the same receivers; parts of\n"
      "several states may be put together where their step numbers agree. ValueError naming\n"
      "what differs.");
}

}  // namespace snowbough::python
