#include "image/rle_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace snowbough::image {
namespace {

using ::testing::ElementsAre;

std::vector<uint8_t> packed(const std::vector<uint8_t>& line) {
  RleLinePacker packer;
  if (!packer.pack(line.data(), line.size())) return {};
  return {packer.packed(), packer.packed() + packer.packed_size()};
}

TEST(RleLine, equalBytesBecomeOneCount) {
  // The first byte stays, the other eleven do not differ from the one before: 128.
  EXPECT_THAT(packed(std::vector<uint8_t>(12, 7)), ElementsAre(255, 7, 10, 128));
}

TEST(RleLine, runsEndAfter128Bytes) {
  EXPECT_THAT(packed(std::vector<uint8_t>(132, 0)), ElementsAre(255, 0, 127, 128, 2, 128));
}

TEST(RleLine, bytesThatDifferCannotBeMadeShorter) {
  EXPECT_THAT(packed({1, 2, 4, 8, 16, 32, 64, 128}), ElementsAre());
}

}  // namespace
}  // namespace snowbough::image
