#pragma once

#include <pybind11/pybind11.h>

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

#include "shaders/lib/snow_surface.h"

namespace snowbough::python {

inline void require_number(double value, const char* name) {
  if (!std::isfinite(value)) {
    throw std::invalid_argument(std::string(name) + " must hold finite numbers");
  }
}

/// The artist's sliders of snow by name. Another slider is another row here.
inline constexpr std::pair<const char*, float shared::SnowStyle::*> kSliders[]{
    {"overhang", &shared::SnowStyle::overhang},
    {"hem_variation", &shared::SnowStyle::hem_variation},
    {"bridging", &shared::SnowStyle::bridging},
    {"relief", &shared::SnowStyle::relief},
};

/// The usual style but for the sliders given. @throws TypeError for other names.
inline shared::SnowStyle style_from(const pybind11::kwargs& sliders) {
  shared::SnowStyle style = shared::usual_style();
  size_t known = 0;
  for (const auto& [name, field] : kSliders) {
    if (!sliders.contains(name)) continue;
    style.*field = pybind11::cast<float>(sliders[name]);
    require_number(style.*field, name);
    ++known;
  }
  if (known != sliders.size()) {
    std::string names;
    for (const auto& [name, field] : kSliders)
      names += (names.empty() ? "" : ", ") + std::string(name);
    throw pybind11::type_error("there is no such slider; the sliders are " + names);
  }
  return style;
}

}  // namespace snowbough::python
