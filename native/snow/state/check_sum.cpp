#include "snow/state/check_sum.h"

#include <zlib.h>

#include <algorithm>

namespace snowbough::snow {

uint32_t check_sum(std::string_view bytes, uint32_t before) {
  uLong sum = before;
  while (!bytes.empty()) {
    const auto part = static_cast<uInt>(std::min(bytes.size(), size_t{1} << 30));
    sum = crc32(sum, reinterpret_cast<const Bytef*>(bytes.data()), part);
    bytes.remove_prefix(part);
  }
  return static_cast<uint32_t>(sum);
}

}  // namespace snowbough::snow
