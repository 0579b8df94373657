#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gpu/program.h"

namespace snowbough::gpu {

/// One shader program in several variants, identified by their defines. A variant is compiled on
/// first use: a bake needs few of them, and compiling delays its first step.
class ProgramVariants {
 public:
  /// `files`: as in Program.
  explicit ProgramVariants(std::vector<std::string> files) : files_(std::move(files)) {}

  /// The variant with these defines, in this order. GPU thread. @throws as Program's constructor.
  Program& with(const std::vector<std::string>& defines) {
    std::unique_ptr<Program>& variant = variants_[defines];
    if (variant == nullptr) {
      variant = std::make_unique<Program>(files_, defines);
    }
    return *variant;
  }

 private:
  std::vector<std::string> files_;
  std::map<std::vector<std::string>, std::unique_ptr<Program>> variants_;
};

}  // namespace snowbough::gpu
