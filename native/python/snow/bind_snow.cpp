#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine_arguments.h"
#include "object_description.h"
#include "output_maps.h"
#include "python/bindings.h"
#include "python/choose.h"
#include "python/numpy_arrays.h"
#include "snow/simulation.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

using snow::SnowSimulation;
using Holder = HeldWithoutGil<SnowSimulation>;

/// The settings with the numbers in `given`. @throws TypeError for unknown names, for settings that
/// cannot change if `is_running`, and for values that are not numbers.
snow::SimulationSettings with_numbers(snow::SimulationSettings settings, const py::kwargs& given,
                                      bool is_running) {
  for (const auto& [key, value] : given) {
    const auto name = py::cast<std::string>(key);
    const auto* row =
        std::find_if(std::begin(snow::kNumberSettings), std::end(snow::kNumberSettings),
                     [&](const auto& one) { return name == one.name; });
    if (row == std::end(snow::kNumberSettings)) {
      throw py::type_error("there is no setting '" + name + "'");
    }
    if (is_running && !row->can_change) {
      throw py::type_error(name + " cannot change: make a new SnowSimulation");
    }
    try {
      settings.*row->field = py::cast<double>(value);
    } catch (const py::cast_error&) {
      throw py::type_error(name + " must be a number");
    }
  }
  return settings;
}

Holder make_simulation(int64_t seed, const std::string& mapping, int32_t tile_size,
                       const std::string& device, const std::string& engine, bool wait_for_gpu,
                       bool landing, bool fall_time, bool granular, bool wet, bool points,
                       const py::kwargs& numbers) {
  const snow::SimulationSettings settings =
      with_numbers({.seed = static_cast<uint32_t>(seed),
                    .landing = landing,
                    .fall_time = fall_time,
                    .granular = granular,
                    .wet = wet,
                    .points = points,
                    .tile_size = tile_size,
                    .engine = {snow::engine_kind(engine), snow::deposit_mapping(mapping), device},
                    .wait_for_gpu = wait_for_gpu},
                   numbers, false);
  const ReleasedGil release;
  return Holder(new SnowSimulation(settings));
}

/// A line for each number: its name, default, meaning and valid values.
std::string describe_numbers() {
  std::string text;
  for (const snow::NumberSetting& one : snow::kNumberSettings) {
    const py::str line =
        py::str("{} = {:g}: {} ({})\n")
            .format(one.name, snow::SimulationSettings{}.*one.field, one.meaning, one.range);
    text += py::cast<std::string>(line);
  }
  return text;
}

/// add_object and replace_object.
template <void (SnowSimulation::*give)(snow::ObjectDescription)>
void give_object(SnowSimulation& simulation, const std::string& name,
                 const InputArray<int32_t>& triangles, const InputArray<float>& uv,
                 int32_t resolution, bool receive, bool occlude, const py::object& rest,
                 const std::optional<double>& blur_radius, const py::object& alpha,
                 const py::object& shading, const std::string& sides) {
  snow::ObjectDescription description = describe_object(
      name, triangles, uv, resolution, receive, occlude, rest, blur_radius, alpha, shading, sides);
  const ReleasedGil release;
  (simulation.*give)(std::move(description));
}

void step(SnowSimulation& simulation, const py::dict& positions, double depth,
          const std::array<double, 3>& direction, double dt, const std::set<std::string>& hidden,
          const std::array<double, 3>& sun, const std::array<double, 2>& wind) {
  std::vector<InputArray<float>> arrays;  // keeps converted copies alive
  snow::PositionMap map;
  for (const auto& [key, value] : positions) {
    const auto name = py::cast<std::string>(key);
    auto array = InputArray<float>::ensure(value);
    if (!array || array.ndim() != 2 || array.shape(1) != 3) {
      PyErr_Clear();
      throw std::invalid_argument("step: positions of object '" + name +
                                  "' must have shape (N, 3)");
    }
    map[name] = {reinterpret_cast<const glm::vec3*>(array.data()),
                 static_cast<size_t>(array.shape(0))};
    arrays.push_back(std::move(array));
  }
  const ReleasedGil release;
  simulation.step(map, depth, {direction[0], direction[1], direction[2]}, dt, hidden,
                  {sun[0], sun[1], sun[2]}, {wind[0], wind[1]});
}

/// Applies the given settings; the others stay.
void change_settings(SnowSimulation& simulation, std::optional<int64_t> seed,
                     std::optional<bool> landing, std::optional<bool> fall_time,
                     std::optional<bool> granular, std::optional<bool> wet,
                     std::optional<bool> points, const py::kwargs& numbers) {
  snow::SimulationSettings settings = with_numbers(simulation.settings(), numbers, true);
  settings.seed = static_cast<uint32_t>(seed.value_or(settings.seed));
  settings.landing = landing.value_or(settings.landing);
  settings.fall_time = fall_time.value_or(settings.fall_time);
  settings.granular = granular.value_or(settings.granular);
  settings.wet = wet.value_or(settings.wet);
  settings.points = points.value_or(settings.points);
  const ReleasedGil release;
  simulation.change_settings(settings);
}

py::dict take_flying(SnowSimulation& simulation) {
  const auto flying = without_gil([&] { return simulation.take_flying(); });
  py::dict by_name;
  for (const auto& [name, parcels] : flying) {
    std::vector<float> rows;
    for (const snow::FlyingSnow& one : parcels) {
      for (const glm::vec3& own : {one.point, one.velocity}) {
        rows.insert(rows.end(), {own.x, own.y, own.z});
      }
      rows.insert(rows.end(), {one.volume, one.seconds});
    }
    by_name[py::str(name)] =
        to_numpy<float>(std::move(rows), {static_cast<py::ssize_t>(parcels.size()), 8});
  }
  return by_name;
}

void set_mask(SnowSimulation& simulation, const std::string& name, const py::object& values,
              const py::object& uv) {
  snow::SnowMask mask;
  if (!values.is_none()) {
    const auto given = InputArray<float>::ensure(values);
    const auto corners = uv.is_none() ? InputArray<float>() : InputArray<float>::ensure(uv);
    if (!given || !corners || given.ndim() != 2 || given.size() == 0 ||
        (uv.is_none() ? given.shape(1) != 3
                      : corners.ndim() != 3 || corners.shape(1) != 3 || corners.shape(2) != 2)) {
      PyErr_Clear();
      throw std::invalid_argument(
          "mask: values must have shape (T, 3) without uv, and (H, W) with uv (T, 3, 2)");
    }
    std::vector<float> numbers(given.data(), given.data() + given.size());
    if (uv.is_none()) {
      mask.corner_weights = std::move(numbers);
    } else {
      const auto* first = reinterpret_cast<const glm::vec2*>(corners.data());
      mask.corner_uv.assign(first, first + corners.size() / 2);
      mask.height = static_cast<int32_t>(given.shape(0));
      mask.width = static_cast<int32_t>(given.shape(1));
      mask.image = std::move(numbers);
    }
  }
  const ReleasedGil release;
  simulation.set_mask(name, mask);
}

void set_presser(SnowSimulation& simulation, const std::string& name, const std::string& kind,
                 double packed_density, double pushed_aside, double rim_width, double walls_stand,
                 bool blocks_wind) {
  using Kind = snow::PressSettings::Kind;
  const Kind chosen = choose<Kind>("kind", kind,
                                   {{"NONE", Kind::kNone},
                                    {"PRESS", Kind::kPress},
                                    {"PLOUGH", Kind::kPlough},
                                    {"CLEAR", Kind::kClear}});
  simulation.set_presser(
      name, {chosen, packed_density, pushed_aside, rim_width, walls_stand, blocks_wind});
}

/// Returns a receiver's map: height or texel_area.
template <std::vector<float> (SnowSimulation::*read)(const std::string&)>
py::array_t<float> map_of(SnowSimulation& simulation, const std::string& name) {
  int32_t edge = 0;
  std::vector<float> values = without_gil([&] {
    edge = simulation.resolution(name);
    return (simulation.*read)(name);
  });
  return to_numpy<float>(std::move(values), {edge, edge});
}

snow::OutputSnapshot snapshot(SnowSimulation& simulation, const std::string& name,
                              const py::kwargs& maps) {
  const snow::MapRequest request = map_request(maps);
  const ReleasedGil release;
  return simulation.snapshot(name, request);
}

py::dict snapshot_output(snow::OutputSnapshot& snapshot) {
  // Moved while the GIL is held, so that only one of two concurrent callers gets the map.
  snow::OutputSnapshot taken = std::move(snapshot);
  snow::MapOutput result = without_gil([&] { return taken.output(); });
  const int32_t resolution = taken.resolution();
  py::dict dict;
  dict["height"] = to_numpy<float>(std::move(result.height), {resolution, resolution});
  put_maps(dict, result, resolution);
  return dict;
}

py::dict output(SnowSimulation& simulation, const std::string& name, const py::kwargs& maps) {
  snow::OutputSnapshot now = snapshot(simulation, name, maps);
  return snapshot_output(now);
}

void put_balance(py::dict& dict, const snow::SnowBalance& balance) {
  dict["deposited_volume"] = balance.deposited_volume;
  dict["slid_volume"] = balance.slid_volume;
  dict["landed_volume"] = balance.landed_volume;
  dict["removed_volume"] = balance.removed_volume;
  dict["held_volume"] = balance.held_volume;
  dict["stretched_volume"] = balance.stretched_volume;
  dict["visible_area"] = balance.visible_area;
  dict["back_face_area"] = balance.back_face_area;
  dict["back_face_share"] = balance.back_face_share();
}

py::dict balance_dict(const snow::StatisticsPair& pair) {
  py::dict dict;
  put_balance(dict, pair.step);
  py::dict total;
  put_balance(total, pair.total);
  total["masked_volume"] = pair.total.masked_volume;
  total["pressed_volume"] = pair.total.pressed_volume;
  total["cleared_volume"] = pair.total.cleared_volume;
  total["melted_volume"] = pair.total.melted_volume;
  total["drifted_volume"] = pair.total.drifted_volume;
  dict["total"] = total;
  return dict;
}

py::dict pass_costs(SnowSimulation& simulation) {
  py::dict dict;
  for (const snow::PassCost& cost : without_gil([&] { return simulation.take_costs(); })) {
    py::dict one;
    one["calls"] = cost.calls;
    one["gpu_seconds"] = cost.gpu_seconds;
    one["wall_seconds"] = cost.wall_seconds;
    dict[py::str(cost.name)] = one;
  }
  return dict;
}

py::list pass_hashes(SnowSimulation& simulation) {
  py::list list;
  for (const snow::PassHash& one : without_gil([&] { return simulation.take_hashes(); })) {
    list.append(py::make_tuple(one.step, one.pass, one.object, one.hash));
  }
  return list;
}

py::dict statistics(SnowSimulation& simulation) {
  const snow::SnowStatistics statistics = without_gil([&] { return simulation.statistics(); });
  py::dict dict = balance_dict(statistics.all);
  dict["step_number"] = statistics.step_number;
  py::dict objects;
  for (const auto& [name, pair] : statistics.objects) {
    objects[py::str(name)] = balance_dict(pair);
  }
  dict["objects"] = objects;
  dict["air_volume"] = statistics.air_volume;
  dict["floor_volume"] = statistics.floor_volume;
  dict["left_volume"] = statistics.left_volume;
  return dict;
}

py::dict memory_estimate(SnowSimulation& simulation) {
  const snow::MemoryEstimate estimate = without_gil([&] { return simulation.memory_estimate(); });
  py::dict dict;
  dict["total"] = estimate.total();
  dict["maps"] = estimate.maps;
  dict["texels"] = estimate.texels;
  dict["geometry"] = estimate.geometry;
  dict["tile"] = estimate.tile;
  dict["output"] = estimate.output;
  dict["seams"] = estimate.seams;
  dict["repose"] = estimate.repose;
  dict["text"] = estimate.text();
  return dict;
}

}  // namespace

void bind_snow(py::module_& module) {
  using namespace py::literals;
  py::class_<snow::OutputSnapshot>(module, "OutputSnapshot",
                                   "A receiver's map at one moment; see SnowSimulation.snapshot.")
      .def("output", &snapshot_output,
           R"(The dict that SnowSimulation.output gave at that moment. Raises RuntimeError on a
second call.)");

  const std::string simulation_doc =
      R"(Simulates snow that accumulates on moving objects, each with a map in UV space.

Settings that are numbers, by keyword, with their defaults:
)" + describe_numbers() +
      R"(
mapping: )" +
      snow::kMappingHelp + R"(. engine: GL
(shaders), CPU (C++ on all cores, needs no graphics driver) or AUTO: GL on a hardware driver, else
CPU; `engine` reports the choice. tile_size (a power of two from 64 to 4096) and device do not
change the result; if a device is named, AUTO means GL. wait_for_gpu: True raises RuntimeError
here if engine GL is requested and not available; False lets objects be added while the driver
loads, and the first call that needs the engine raises.

landing: snow that leaves a map falls onto what lies below, and meets the snow of other receivers;
False, or with repose at pi / 2: it is gone, and a receiver's snow depends on its own only.
fall_time: whether a fall takes time, sqrt(2 H / g), but no longer than open snow needs to grow by
1 cm. granular: whether heaps are round cones at the angle of repose, as of sand; rounds take longer.
wet: whether melted snow and rain wet surfaces, see output. points: whether to record snow for
take_flying.

A context manager: leaving it closes the simulation.)";
  py::class_<SnowSimulation, Holder>(module, "SnowSimulation", simulation_doc.c_str())
      .def(py::init(&make_simulation), py::kw_only(), "seed"_a = 0, "mapping"_a = "COMPUTE",
           "tile_size"_a = 2048, "device"_a = "", "engine"_a = "AUTO", "wait_for_gpu"_a = true,
           "landing"_a = true, "fall_time"_a = true, "granular"_a = false, "wet"_a = false,
           "points"_a = false)
      .def_property_readonly(
          "engine",
          [](SnowSimulation& simulation) {
            return engine_dict(without_gil([&] { return simulation.engine_info(); }));
          },
          R"(The engine, after waiting for it: a dict of 'name' (GL or CPU), 'driver' (everything
that can change the last bits of a result) and 'reason' (why it was chosen).)")
      .def("add_object", &give_object<&SnowSimulation::add_object>, "name"_a, "triangles"_a, "uv"_a,
           "resolution"_a = 1024, "receive"_a = true, "occlude"_a = true, "rest"_a = py::none(),
           "blur_radius"_a = py::none(), "alpha"_a = py::none(), "shading"_a = py::none(),
           "sides"_a = "AUTO",
           R"(Adds a mesh: triangles (T, 3) vertex indices, uv (T, 3, 2) in [0, 1]. A receiver gets
a map of resolution x resolution texels, and always occludes, too. rest (N, 3): the pose in which
output measures distances, in metres; by default the pose of its first step. blur_radius: standard
deviation in metres for this object, by default the simulation's.

alpha: holes through which snow falls, a dict: 'uv' (T, 3, 2) any floats, 'image' (T,) index into
'images' or -1 for opaque triangles, 'images' [(H, W) uint8, row 0 = v 0; 128 and more is opaque],
'extensions' [REPEAT, MIRROR, EXTEND or CLIP] for each image.

shading (T, 3) int32: corners with the same number share a smooth normal, computed from the
positions of each step; -1, or None for all: flat. Thickness follows the smooth normals, and the
total snow equals what falls on the triangles.

sides: the sides that take snow. POSITIVE, from which triangles run anticlockwise; BOTH: the side
that faces the sky, with negative heights on the back; AUTO: BOTH for parts of the mesh without an
inside (cards, leaves, flags, bowls, by the rest pose), POSITIVE for the others.)")
      .def("replace_object", &give_object<&SnowSimulation::replace_object>, "name"_a, "triangles"_a,
           "uv"_a, "resolution"_a = 1024, "receive"_a = true, "occlude"_a = true,
           "rest"_a = py::none(), "blur_radius"_a = py::none(), "alpha"_a = py::none(),
           "shading"_a = py::none(), "sides"_a = "AUTO",
           R"(Replaces an object's mesh from the next step on, which must give its positions. A
receiver keeps its map wherever the new mesh has a surface in UV space; other snow is removed and
counts as stretched_volume. Resolution and receive stay. Arguments as in add_object.)")
      .def("step", &step, "positions"_a, "depth"_a, "direction"_a = std::array<double, 3>{0, 0, -1},
           "dt"_a = 1.0 / 24.0, "hidden"_a = std::set<std::string>(),
           "sun"_a = std::array<double, 3>{0, 0, 0}, "wind"_a = std::array<double, 2>{0, 0},
           R"(Simulates one step of snowfall: depth in metres on open level ground, along direction,
within dt seconds (0: nothing slides or moves). positions: {name: (N, 3) metres} of the objects
that moved; each object must be given in its first step. hidden: names of objects that keep their
snow, gain none and block none in this step. A negative depth lets lying snow thaw by so much where
the ground is open and level: sun is the direction of the sun's light, zero without sun.
wind is the horizontal direction in which drift carries lying snow; zero: it stays.)")
      .def("change_settings", &change_settings, py::kw_only(), "seed"_a = py::none(),
           "landing"_a = py::none(), "fall_time"_a = py::none(), "granular"_a = py::none(),
           "wet"_a = py::none(), "points"_a = py::none(),
           R"(Applies other settings, except pixel_size and blur_radius, from the next step on, in
the constructor's units; the snow and all settings that are not given stay. Raises ValueError for
values out of range.)")
      .def("set_blur_radius", &SnowSimulation::set_blur_radius, "name"_a, "blur_radius"_a,
           py::call_guard<ReleasedGil>(),
           R"(Sets the standard deviation in metres of the blur of one receiver's output; the stored
map stays.)")
      .def(
          "set_mask", &set_mask, "name"_a, "values"_a = py::none(), "uv"_a = py::none(),
          R"(Sets how much of the snow a receiver takes, 0 (none) to 1 (all), from the next step on:
values (T, 3) of the triangles' corners; or with uv (T, 3, 2) an image (H, W), row 0 = v 0. Without
values, and by replace_object, the mask is removed. A mask scales what falls and lands, and the
depth that may lie; snow shrinks with a mask that decreases. What is refused counts as
masked_volume.)")
      .def("set_shed_half_life", &SnowSimulation::set_shed_half_life, "name"_a, "half_life"_a,
           py::call_guard<ReleasedGil>(),
           R"(Sets the seconds in which half of a receiver's snow lets go and falls, lump by lump,
from the next step on; 0: none does.)")
      .def("set_presser", &set_presser, "name"_a, "kind"_a = "PRESS", py::kw_only(),
           "packed_density"_a = snow::PressSettings{}.packed_density,
           "pushed_aside"_a = snow::PressSettings{}.pushed_aside,
           "rim_width"_a = snow::PressSettings{}.rim_width,
           "walls_stand"_a = snow::PressSettings{}.walls_stand, "blocks_wind"_a = true,
           py::call_guard<ReleasedGil>(),
           R"(Sets what an object does to the snow of others that it touches: PRESS packs it (feet,
wheels), PLOUGH pushes all of it ahead and aside (blades), CLEAR removes it, NONE. packed_density:
in kg/m3, of fresh snow with 100; pushed_aside: fraction of displaced snow that is not packed;
rim_width: metres over which it spreads; walls_stand: metres up to which walls of packed snow stand;
blocks_wind: whether the wind that carries snow stops at it, rather than to pass it as a tree. Counts as pressed_volume and cleared_volume. A step without duration presses nothing.)")
      .def("take_flying", &take_flying,
           R"(What has begun to fly in the steps since the last call, with the setting points:
{receiver that it left: (N, 8) float32}. Columns: position in metres and velocity in m/s at the end
of its step, volume in m3, seconds until it lands. Snow that blades throw up stays on the map, too.)")
      .def("height", &map_of<&SnowSimulation::height>, "name"_a,
           R"(Stored thickness along the normal in metres, (H, W) float32, row 0 = v 0; negative for
snow on the back.)")
      .def("output", &output, "name"_a,
           R"({'height': (H, W) smoothed by blur_radius, 'normal': (H, W, 3) in tangent space},
extended beyond the charts and level at seams. normal=False omits the normals.)")
      .def("snapshot", &snapshot, "name"_a,
           R"(The input of output at this moment, as an object whose output() computes it: once, on
any thread, also while the simulation continues or after it is closed. Arguments as in output.)")
      .def("prepare_output", &SnowSimulation::prepare_output, "name"_a,
           py::call_guard<ReleasedGil>(),
           R"(Starts building the tables that output of a receiver needs, beside the next steps, and
returns at once; changes no result. Raises ValueError before its rest pose is known.)")
      .def("texel_area", &map_of<&SnowSimulation::texel_area>, "name"_a,
           R"(Area in m2 that each texel covers in the current pose, (H, W) float32, 0 outside the
surface.)")
      .def("measure_passes", &SnowSimulation::measure_passes, "on"_a, py::call_guard<ReleasedGil>(),
           "Starts or stops measuring the passes of engine GL.")
      .def("pass_costs", &pass_costs,
           R"(Costs of the passes of engine GL since the last call, by name: 'calls', 'gpu_seconds'
by the GPU's clock, 'wall_seconds' of submitting them. Empty unless measure_passes(True).)")
      .def("hash_passes", &SnowSimulation::hash_passes, "on"_a, py::call_guard<ReleasedGil>(),
           "Starts or stops hashing what the passes of each step write, to find where runs differ.")
      .def("pass_hashes", &pass_hashes,
           R"(Hashes of the steps since the last call: (step, pass, object, CRC-32), in the order in
which the passes ran. Empty unless hash_passes(True).)")
      .def("statistics", &statistics,
           R"(Balance of the last step, under 'total' of all steps, and under 'objects' per
receiver: volumes in m3, areas in m2.)")
      .def("memory_estimate", &memory_estimate,
           "Memory that the simulation needs, in bytes by kind, and as a line of text.")
      .def("close", &SnowSimulation::close, py::call_guard<ReleasedGil>(),
           "Releases everything. Further calls raise RuntimeError.")
      .def(
          "__enter__", [](SnowSimulation& self) -> SnowSimulation& { return self; },
          py::return_value_policy::reference_internal)
      .def("__exit__", [](SnowSimulation& self, const py::args&) {
        const ReleasedGil release;
        self.close();
      });
}

}  // namespace snowbough::python
