#include "image/png.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace snowbough::image {
namespace {

TEST(Png, hasItsSignatureSizeAndDepth) {
  const std::vector<uint16_t> samples{0, 65535, 1, 2, 3, 4};
  const std::string bytes = encode_png(2, 1, 3, samples.data());
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x89PNG\r\n\x1a\n", 8));
  EXPECT_EQ(bytes.substr(16, 10), std::string("\0\0\0\x02\0\0\0\x01\x10\x02", 10));
  EXPECT_THROW(encode_png(0, 1, 3, samples.data()), std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::image
