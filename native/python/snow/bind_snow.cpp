#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine_arguments.h"
#include "object_description.h"
#include "python/bindings.h"
#include "python/numpy_arrays.h"
#include "snow/simulation.h"

namespace py = pybind11;

namespace snowbough::python {
namespace {

using snow::SnowSimulation;
using Holder = HeldWithoutGil<SnowSimulation>;

Holder make_simulation(double pixel_size, double noise_density, double flutter, double max_depth,
                       double slide_half_life, double repose, double cohesion, double blur_radius,
                       int64_t seed, const std::string& mapping, int32_t tile_size,
                       const std::string& device, const std::string& engine, bool wait_for_gpu) {
  snow::SimulationSettings settings{pixel_size,
                                    noise_density,
                                    flutter,
                                    max_depth,
                                    slide_half_life,
                                    repose,
                                    cohesion,
                                    blur_radius,
                                    static_cast<uint32_t>(seed),
                                    mapping_from(mapping),
                                    tile_size,
                                    snow::engine_kind(engine),
                                    device,
                                    wait_for_gpu};
  const ReleasedGil release;
  return Holder(new SnowSimulation(settings));
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
          const std::array<double, 3>& direction, double dt) {
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
  simulation.step(map, depth, {direction[0], direction[1], direction[2]}, dt);
}

/// Takes over the named settings that are given; the others stay.
void change_settings(SnowSimulation& simulation, std::optional<double> noise_density,
                     std::optional<double> flutter, std::optional<double> max_depth,
                     std::optional<double> slide_half_life, std::optional<double> repose,
                     std::optional<double> cohesion, std::optional<int64_t> seed) {
  snow::SimulationSettings settings = simulation.settings();
  settings.noise_density = noise_density.value_or(settings.noise_density);
  settings.flutter = flutter.value_or(settings.flutter);
  settings.max_depth = max_depth.value_or(settings.max_depth);
  settings.slide_half_life = slide_half_life.value_or(settings.slide_half_life);
  settings.repose = repose.value_or(settings.repose);
  settings.cohesion = cohesion.value_or(settings.cohesion);
  settings.seed = static_cast<uint32_t>(seed.value_or(settings.seed));
  const ReleasedGil release;
  simulation.change_settings(settings);
}

/// A map of a receiver by its name: height and texel_area.
template <std::vector<float> (SnowSimulation::*read)(const std::string&)>
py::array_t<float> map_of(SnowSimulation& simulation, const std::string& name) {
  int32_t edge = 0;
  std::vector<float> values = without_gil([&] {
    edge = simulation.resolution(name);
    return (simulation.*read)(name);
  });
  return to_numpy<float>(std::move(values), {edge, edge});
}

snow::OutputSnapshot snapshot(SnowSimulation& simulation, const std::string& name, bool normal) {
  const ReleasedGil release;
  return simulation.snapshot(name, normal);
}

/// A map that numpy looks at, and who takes its memory then.
struct PooledArray {
  PooledArray(std::vector<float>&& map, std::shared_ptr<snow::MapMemory> taker)
      : heights(std::move(map)), memory(std::move(taker)) {}
  ~PooledArray() {
    if (memory != nullptr) memory->give(std::move(heights));
  }
  PooledArray(const PooledArray&) = delete;
  PooledArray& operator=(const PooledArray&) = delete;

  std::vector<float> heights;
  std::shared_ptr<snow::MapMemory> memory;
};

py::dict snapshot_output(snow::OutputSnapshot& snapshot) {
  // Moved while the GIL is held, so that of two threads that call this one gets the map.
  snow::OutputSnapshot taken = std::move(snapshot);
  snow::MapOutput result = without_gil([&] { return taken.output(); });
  const int32_t resolution = taken.resolution();
  py::dict dict;
  auto map = std::make_unique<PooledArray>(std::move(result.height), taken.memory());
  float* const heights = map->heights.data();
  dict["height"] = owned_numpy(std::move(map), heights, {resolution, resolution});
  if (!result.normal.empty()) {
    dict["normal"] = to_numpy<float>(std::move(result.normal), {resolution, resolution, 3});
  }
  return dict;
}

py::dict output(SnowSimulation& simulation, const std::string& name, bool normal) {
  snow::OutputSnapshot now = snapshot(simulation, name, normal);
  return snapshot_output(now);
}

void put_balance(py::dict& dict, const snow::SnowBalance& balance) {
  dict["deposited_volume"] = balance.deposited_volume;
  dict["slid_volume"] = balance.slid_volume;
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

py::dict statistics(SnowSimulation& simulation) {
  const snow::SnowStatistics statistics = without_gil([&] { return simulation.statistics(); });
  py::dict dict = balance_dict(statistics.all);
  dict["step_number"] = statistics.step_number;
  py::dict objects;
  for (const auto& [name, pair] : statistics.objects) {
    objects[py::str(name)] = balance_dict(pair);
  }
  dict["objects"] = objects;
  return dict;
}

py::dict memory_estimate(const SnowSimulation& simulation) {
  const snow::MemoryEstimate estimate = simulation.memory_estimate();
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
           "The dict that SnowSimulation.output gave at that moment. RuntimeError for a second "
           "call.");

  py::class_<SnowSimulation, Holder>(
      module, "SnowSimulation",
      "Snow that accumulates on moving objects, each with a map in UV space.\n\n"
      "pixel_size: edge of an occlusion pixel in metres. noise_density: share of pixels that snow "
      "in\n"
      "a step (mean unchanged). flutter: radians by which flakes stray. max_depth: metres that "
      "level\n"
      "ground holds. slide_half_life: seconds. repose: radians from level, over 0 to pi / 2, that\n"
      "snow's own surface keeps before it moves to what lies lower, or over a rim into the air, "
      "where\n"
      "it has slid; walls then hold nothing for longer than a second. pi / 2: snow stays where it\n"
      "fell. cohesion: metres that a front of snow stands upright; what is smooth and as thin as\n"
      "that, as twigs are, carries steeper snow. blur_radius: sigma of output's blur in metres.\n"
      "mapping: COMPUTE, or GEOMETRY for the thesis's own scatter, which only the engine GL has.\n"
      "engine: GL (shaders), CPU (C++ on all cores, no graphics driver needed) or AUTO: GL on a\n"
      "hardware driver, else CPU; `engine` tells which it is. tile_size (a power of two from 64 "
      "to\n"
      "4096) and device change neither result nor units; where a device is named, AUTO is GL.\n"
      "wait_for_gpu: whether RuntimeError is raised here where the engine GL is asked for and not "
      "to\n"
      "be had; else objects can be added while the driver is being loaded, and the first call "
      "that\n"
      "needs it raises.\n"
      "A context manager: leaving it closes the simulation.")
      .def(py::init(&make_simulation), "pixel_size"_a = 0.01, "noise_density"_a = 1.0,
           "flutter"_a = 0.0, "max_depth"_a = 1.0, "slide_half_life"_a = 2.0,
           "repose"_a = snow::SimulationSettings{}.repose, "cohesion"_a = 0.0,
           "blur_radius"_a = 0.0, "seed"_a = 0, "mapping"_a = "COMPUTE", "tile_size"_a = 2048,
           "device"_a = "", "engine"_a = "AUTO", "wait_for_gpu"_a = true)
      .def_property_readonly(
          "engine",
          [](SnowSimulation& simulation) {
            return engine_dict(without_gil([&] { return simulation.engine_info(); }));
          },
          "What does the passes, waited for: a dict of 'name' (GL or CPU), 'driver' (what decides\n"
          "about last bits) and 'reason' (why this one).")
      .def(
          "add_object", &give_object<&SnowSimulation::add_object>, "name"_a, "triangles"_a, "uv"_a,
          "resolution"_a = 1024, "receive"_a = true, "occlude"_a = true, "rest"_a = py::none(),
          "blur_radius"_a = py::none(), "alpha"_a = py::none(), "shading"_a = py::none(),
          "sides"_a = "AUTO",
          "Adds a mesh: triangles (T, 3) vertex indices, uv (T, 3, 2) in [0, 1]. A receiver gets "
          "a\n"
          "map of resolution x resolution texels, and occludes whatever `occlude` says. rest (N, "
          "3):\n"
          "the pose in which output measures distances, in metres; by default that of its first "
          "step.\n"
          "blur_radius: sigma in metres for this object, by default the simulation's.\n"
          "alpha: where snow falls through, a dict: 'uv' (T, 3, 2) any floats, 'image' (T,) index "
          "into\n"
          "'images' or -1 for opaque triangles, 'images' [(H, W) uint8, row 0 = v 0; 128 and more "
          "is\n"
          "there], 'extensions' [REPEAT, MIRROR, EXTEND or CLIP] for each image.\n"
          "shading (T, 3) int32: corners of one number share a smooth normal, worked out from the\n"
          "positions of each step; -1, or None for all: flat. Thickness follows the smooth "
          "normals, and\n"
          "the snow on all of the surface stays what falls on its triangles.\n"
          "sides: which take snow. FRONT, where triangles run anticlockwise; BOTH: the one that "
          "faces\n"
          "the sky, heights being negative on the back; AUTO: BOTH for the parts of the mesh that "
          "have\n"
          "no inside (cards, leaves, flags, bowls, by the rest pose), FRONT for the others.")
      .def("replace_object", &give_object<&SnowSimulation::replace_object>, "name"_a, "triangles"_a,
           "uv"_a, "resolution"_a = 1024, "receive"_a = true, "occlude"_a = true,
           "rest"_a = py::none(), "blur_radius"_a = py::none(), "alpha"_a = py::none(),
           "shading"_a = py::none(), "sides"_a = "AUTO",
           "Gives an object another mesh, from the next step on, which must name it. A receiver "
           "keeps\n"
           "its map wherever the new mesh has a surface in UV space; the rest goes, and counts as\n"
           "stretched_volume. Resolution and receive stay. Arguments as in add_object.")
      .def("step", &step, "positions"_a, "depth"_a, "direction"_a = std::array<double, 3>{0, 0, -1},
           "dt"_a = 1.0 / 24.0,
           "Lets snow fall: depth in metres on open level ground, along direction, within dt "
           "seconds\n(0: nothing slides or moves).\n"
           "positions: {name: (N, 3) metres} of the objects that moved; an object's first step "
           "must\n"
           "name it, later ones only when it moved.")
      .def(
          "change_settings", &change_settings, py::kw_only(), "noise_density"_a = py::none(),
          "flutter"_a = py::none(), "max_depth"_a = py::none(), "slide_half_life"_a = py::none(),
          "repose"_a = py::none(), "cohesion"_a = py::none(), "seed"_a = py::none(),
          "Takes other settings from the next step on, in the constructor's units; the snow that\n"
          "lies stays, and so do settings that are not named. ValueError for what is out of range.")
      .def("set_blur_radius", &SnowSimulation::set_blur_radius, "name"_a, "blur_radius"_a,
           py::call_guard<ReleasedGil>(),
           "Another sigma in metres for the blur of a receiver's output; the stored map stays.")
      .def("height", &map_of<&SnowSimulation::height>, "name"_a,
           "Stored thickness along the normal in metres, (H, W) float32, row 0 = v 0; negative "
           "where it\n"
           "lies on the back.")
      .def(
          "output", &output, "name"_a, "normal"_a = true,
          "{'height': (H, W) smoothed by blur_radius, 'normal': (H, W, 3) in tangent space}, both\n"
          "continued beyond the charts and level at seams. normal=False leaves the normals out.")
      .def("snapshot", &snapshot, "name"_a, "normal"_a = true,
           "What output would give now, as an object whose output() works it out: once, on any\n"
           "thread, also while the simulation goes on or when it is closed.")
      .def(
          "prepare_output", &SnowSimulation::prepare_output, "name"_a,
          py::call_guard<ReleasedGil>(),
          "Begins with what output of a receiver needs to build first, beside the next steps, and\n"
          "returns at once; changes no result. ValueError before its rest pose is known.")
      .def("save", &SnowSimulation::save, "path"_a, py::call_guard<ReleasedGil>(),
           "Writes a checkpoint atomically.")
      .def("restore", &SnowSimulation::restore, "path"_a, "any_driver"_a = false,
           py::call_guard<ReleasedGil>(),
           "Takes a checkpoint of a simulation with the same settings and objects, and goes on bit "
           "for\n"
           "bit. RuntimeError for a file that is none or is damaged, ValueError naming what "
           "differs.")
      .def("texel_area", &map_of<&SnowSimulation::texel_area>, "name"_a,
           "Area in m2 that each texel covers now, (H, W) float32, 0 where there is no surface.")
      .def("measure_passes", &SnowSimulation::measure_passes, "on"_a, py::call_guard<ReleasedGil>(),
           "Whether the engine GL measures its passes from now on.")
      .def("pass_costs", &pass_costs,
           "What the passes of the engine GL took since the last call, by name: 'calls', "
           "'gpu_seconds' of\nthe GPU's own clock, 'wall_seconds' of handing them in. Empty "
           "unless measure_passes(True).")
      .def(
          "statistics", &statistics,
          "Balance of the last step, under 'total' of all steps, and under 'objects' by receiver:\n"
          "volumes in m3, areas in m2.")
      .def("memory_estimate", &memory_estimate,
           "What the simulation takes, in bytes by kind, and as a line of text.")
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
