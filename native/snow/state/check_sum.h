#pragma once

#include <cstdint>
#include <string_view>

namespace snowbough::snow {

/// CRC-32 of any number of bytes (ISO 3309, as in zlib). `before`: the sum of the bytes before.
uint32_t check_sum(std::string_view bytes, uint32_t before = 0);

}  // namespace snowbough::snow
