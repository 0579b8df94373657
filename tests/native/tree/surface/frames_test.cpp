#include "tree/surface/frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

namespace snowbough::tree {
namespace {

TEST(Frames, TransportAlongAQuarterCircleDoesNotTwist) {
  Frame frame = first_frame({0.0, 0.0, 1.0});
  const glm::dvec3 start = frame.u;
  for (int i = 1; i <= 90; ++i) {
    const double angle = i * M_PI / 180.0;
    frame = transport(frame, {std::sin(angle), 0.0, std::cos(angle)});
  }
  // The component across the plane of the bend stays what it was.
  EXPECT_NEAR(frame.u.y, start.y, 1e-9);
  EXPECT_NEAR(glm::length(frame.u), 1.0, 1e-12);
}

}  // namespace
}  // namespace snowbough::tree
