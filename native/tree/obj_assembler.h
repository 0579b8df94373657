#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "tree/obj_fragment.h"
#include "tree/obj_scene.h"

namespace snowbough::tree {

/// Adds the fragments of a file in their order to an ObjScene.
class ObjAssembler {
 public:
  /// @param name what errors call the source.
  explicit ObjAssembler(std::string name);

  /// @throws std::invalid_argument "<name>:<line>: ..." for the first line that cannot be read.
  void append(const ObjFragment& fragment);

  /// @throws std::invalid_argument for indices that point past the file's end, and for a source
  ///   without vertices or faces.
  ObjScene finish();

  ObjCounts counts() const;

 private:
  /// Gives every distinct name a number in the order of appearance.
  class NameTable {
   public:
    int32_t index(std::vector<std::string>& names, const std::string& name);

   private:
    std::unordered_map<std::string, int32_t> numbers_;
  };

  [[noreturn]] void fail(int64_t line, const std::string& what) const;
  void check_room(const ObjFragment& fragment) const;
  void append_runs(const ObjFragment& fragment);
  void append_corners(const ObjFragment& fragment);
  void resolve(const ObjFragment& fragment, size_t first_corner);
  void append_forward(const ObjFragment& fragment);

  std::string name_;
  ObjScene scene_;
  NameTable groups_;
  NameTable materials_;
  FaceRun run_;
  int64_t normal_count_ = 0;
  int64_t line_count_ = 1;
  std::vector<ForwardIndex> forward_[3];
};

}  // namespace snowbough::tree
