#include "gpu/shader_source.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace snowbough::gpu {
namespace {

TEST(ShaderSource, PutsVersionThenDefinesThenTheIncludedText) {
  const std::string source = shader_source("shared_types.h", {"SIZE 4"});
  EXPECT_TRUE(source.starts_with("#version 450 core\n"));
  EXPECT_NE(source.find("#define SIZE 4\n"), std::string::npos);
  EXPECT_EQ(source.find("#pragma once"), std::string::npos);
  EXPECT_THROW(shader_source("missing.comp.glsl"), std::runtime_error);
}

}  // namespace
}  // namespace snowbough::gpu
