#include <pybind11/stl.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <optional>
#include <tuple>

#include "python/bindings.h"
#include "python/numpy_arrays.h"
#include "snow/simulation.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

/// Sums of a state without thaw and drifts, and of states from before them.
constexpr py::ssize_t kFirstSums = 16;

using snow::SnowSimulation;

py::dict to_dict(snow::SimulationState&& state) {
  py::dict objects;
  for (snow::ObjectState& object : state.objects) {
    py::dict own;
    const py::ssize_t edge = object.resolution;
    own["height"] = to_numpy<float>(std::move(object.height), {edge, edge});
    size_t count = object.sums.size();
    while (count > size_t{kFirstSums} && object.sums[count - 1] == 0.0) --count;
    own["sums"] = copied_numpy(object.sums.data(), count);
    py::dict planes;
    for (auto& [name, plane] : object.planes) {
      planes[py::str(name)] = to_numpy<float>(std::move(plane), {edge, edge});
    }
    if (!planes.empty()) own["planes"] = planes;
    objects[py::str(object.name)] = own;
  }
  py::dict result;
  result["step_number"] = state.step_number;
  result["objects"] = objects;
  py::list air;
  for (const snow::FallingSnow& snow : state.landing.air) {
    air.append(py::make_tuple(snow.time, snow.receiver, snow.place, snow.is_back, snow.units));
  }
  py::dict landing;
  landing["air"] = air;
  landing["clock"] = state.landing.clock;
  landing["on_floors"] = state.landing.on_floors;
  landing["left"] = state.landing.left;
  result["landing"] = landing;
  py::dict pressers;
  for (auto& [name, positions] : state.pressers) {
    const auto points = static_cast<py::ssize_t>(positions.size());
    pressers[py::str(name)] = to_numpy<float>(std::move(positions), {points, 3});
  }
  if (!pressers.empty()) result["pressers"] = pressers;
  return result;
}

snow::ObjectState object_of(const std::string& name, const py::dict& own) {
  snow::ObjectState object;
  object.name = name;
  const auto height = py::cast<InputArray<float>>(own["height"]);
  const auto sums = py::cast<InputArray<double>>(own["sums"]);
  if (height.ndim() != 2 || height.shape(0) != height.shape(1)) {
    throw std::invalid_argument("state of '" + name + "': height must have shape (H, H)");
  }
  const auto most = static_cast<py::ssize_t>(object.sums.size());
  if (sums.size() < kFirstSums || sums.size() > most) {
    throw std::invalid_argument("state of '" + name + "': sums must have " + std::to_string(most) +
                                " values");
  }
  object.resolution = static_cast<int32_t>(height.shape(0));
  object.height.assign(height.data(), height.data() + height.size());
  std::copy_n(sums.data(), sums.size(), object.sums.begin());
  if (own.contains("planes")) {
    for (const auto& [key, value] : py::cast<py::dict>(own["planes"])) {
      const auto plane = py::cast<InputArray<float>>(value);
      object.planes[py::cast<std::string>(key)].assign(plane.data(), plane.data() + plane.size());
    }
  }
  return object;
}

snow::SimulationState from_dict(const py::dict& given) {
  snow::SimulationState state;
  state.step_number = py::cast<uint32_t>(given["step_number"]);
  for (const auto& [key, own] : py::cast<py::dict>(given["objects"])) {
    state.objects.push_back(object_of(py::cast<std::string>(key), py::cast<py::dict>(own)));
  }
  if (given.contains("landing")) {
    const auto landing = py::cast<py::dict>(given["landing"]);
    state.landing.clock = py::cast<int64_t>(landing["clock"]);
    state.landing.on_floors = py::cast<int64_t>(landing["on_floors"]);
    state.landing.left = py::cast<int64_t>(landing["left"]);
    for (const py::handle& one : py::cast<py::list>(landing["air"])) {
      const auto [time, receiver, place, is_back, units] =
          py::cast<std::tuple<int64_t, std::string, int32_t, bool, int64_t>>(one);
      state.landing.air.push_back({time, receiver, place, is_back, units});
    }
  }
  if (given.contains("pressers")) {
    for (const auto& [key, value] : py::cast<py::dict>(given["pressers"])) {
      state.pressers[py::cast<std::string>(key)] = rows_from_numpy<glm::vec3, float, 3>(
          py::cast<InputArray<float>>(value), "positions of a presser");
    }
  }
  std::sort(state.objects.begin(), state.objects.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  return state;
}

py::dict state_of(SnowSimulation& simulation) {
  return to_dict(without_gil([&] { return simulation.state(); }));
}

void set_state(SnowSimulation& simulation, const py::dict& given) {
  const snow::SimulationState state = from_dict(given);
  const ReleasedGil release;
  simulation.set_state(state);
}

void write_checkpoint(const std::string& path, const py::dict& given,
                      const std::string& description) {
  const snow::Checkpoint checkpoint{description, from_dict(given)};
  const ReleasedGil release;
  snow::save_checkpoint(path, checkpoint);
}

py::dict read_checkpoint(const std::string& path,
                         const std::optional<std::map<std::string, int32_t>>& receivers) {
  snow::Checkpoint checkpoint = without_gil([&] {
    return snow::load_checkpoint(path, [&](const snow::CheckpointOutline& outline) {
      for (const auto& [name, resolution] : outline.maps) {
        if (!receivers) return;
        const auto found = receivers->find(name);
        if (found == receivers->end() || found->second != resolution) {
          throw std::invalid_argument(path + " holds a map of '" + name + "' with " +
                                      std::to_string(resolution) +
                                      " texels per side, which is not among receivers");
        }
      }
    });
  });
  py::dict result = to_dict(std::move(checkpoint.state));
  result["description"] = checkpoint.description;
  return result;
}

}  // namespace

void bind_snow_state(py::module_& module) {
  using namespace py::literals;
  module.def(
      "simulation_state", &state_of, "simulation"_a,
      R"(The content of a checkpoint of a SnowSimulation, as plain arrays: {'step_number': int,
'objects': {receiver: {'height': (H, H) float32 metres, 'sums': (16,), with thaw (17,), with drifts (18,) float64}}, 'landing': {'clock':
time, 'air': [(time when it lands, receiver, row * resolution + column, on its back, volume)],
'on_floors': volume, 'left': volume}}. Times are in microseconds, these volumes in units of
2^-44 m3. With masks or objects that press snow, receivers have 'planes' {name: (H, H) float32}, and
'pressers' holds {name: (N, 3) metres}.)");
  module.def(
      "set_simulation_state", &set_state, "simulation"_a, "state"_a,
      R"(Restores a state from simulation_state, for a simulation with the same receivers; parts of
several states may be combined if their step numbers agree. Raises ValueError naming the
difference.)");
  module.def("write_checkpoint", &write_checkpoint, "path"_a, "state"_a, "description"_a = "",
             R"(Writes a state from simulation_state, or some of its receivers, atomically
(docs/formats.md). `description`: a text that identifies the simulation. Raises
RuntimeError with path and reason.)");
  module.def("read_checkpoint", &read_checkpoint, "path"_a, "receivers"_a = py::none(),
             R"(Reads a file of write_checkpoint, bit for bit: a state with
'description' added. receivers: {name: resolution} of the maps that it may hold; raises ValueError
for others, before memory is allocated for them. Raises RuntimeError for a file that is missing, of
another version, truncated or damaged.)");
}

}  // namespace snowbough::python
