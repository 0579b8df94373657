#pragma once

#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>

namespace snowbough::python {

/// The choice with the name `value`. @throws std::invalid_argument listing the names.
template <typename Choice>
Choice choose(const std::string& option, const std::string& value,
              std::initializer_list<std::pair<const char*, Choice>> choices) {
  std::string known;
  for (const auto& [name, choice] : choices) {
    if (value == name) {
      return choice;
    }
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  throw std::invalid_argument(option + " must be one of " + known + ", not '" + value + "'");
}

}  // namespace snowbough::python
