#include "image/png.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "image/atomic_file.h"
#include "native/image/temporary_folder.h"

namespace snowbough::image {
namespace {

using Png = TemporaryFolder;

TEST_F(Png, pngHasItsSignatureSizeAndDepth) {
  const std::vector<uint16_t> samples{0, 65535, 1, 2, 3, 4};
  write_png16(path("a.png"), 2, 1, 3, samples.data());
  const std::string bytes = read_file(path("a.png"));
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x89PNG\r\n\x1a\n", 8));
  EXPECT_EQ(bytes.substr(16, 10), std::string("\0\0\0\x02\0\0\0\x01\x10\x02", 10));
  EXPECT_THROW(write_png16(path("b.png"), 0, 1, 3, samples.data()), std::invalid_argument);
}

}  // namespace
}  // namespace snowbough::image
