#pragma once

#include <pybind11/pybind11.h>

#include <utility>
#include <variant>
#include <vector>

#include "python/numpy_arrays.h"
#include "snow/output/map_output.h"

namespace snowbough::python {

/// All maps on request, except those that `given` holds as False. @throws TypeError for other
/// names.
inline snow::MapRequest map_request(const pybind11::kwargs& given) {
  snow::MapRequest request;
  pybind11::ssize_t known = 0;
  for (const snow::MapKind& kind : snow::kMapsOnRequest) {
    const bool is_given = given.contains(kind.name);
    known += is_given ? 1 : 0;
    request.*kind.is_requested = !is_given || pybind11::cast<bool>(given[kind.name]);
  }
  if (known < pybind11::ssize_t(given.size())) {
    throw pybind11::type_error("there is no such map: use the keys of SnowSimulation.output");
  }
  return request;
}

/// Moves the maps on request that the output has into the dict.
inline void put_maps(pybind11::dict& dict, snow::MapOutput& output, int32_t resolution) {
  for (const snow::MapKind& kind : snow::kMapsOnRequest) {
    std::visit(
        [&](auto field) {
          auto& values = output.*field;
          if (values.empty()) return;
          std::vector<pybind11::ssize_t> shape{resolution, resolution};
          constexpr size_t kChannels = sizeof(values[0]) / sizeof(float);
          if (kChannels > 1) shape.push_back(kChannels);
          dict[kind.name] = to_numpy<float>(std::move(values), std::move(shape));
        },
        kind.values);
  }
}

}  // namespace snowbough::python
