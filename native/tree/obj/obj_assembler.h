#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "tree/obj/obj_fragment.h"
#include "tree/obj/obj_scene.h"

namespace snowbough::tree {

/// Makes an ObjScene of a file's fragments.
class ObjAssembler {
 public:
  /// @param name what errors call the source.
  explicit ObjAssembler(std::string name);

  /// Adds what follows in the file.
  /// @param share  of the file that is read then, 0..1, for the room to be made; 0 = unknown.
  /// @param threads  that share the work, the calling one included; 0 = one a core.
  /// @throws std::invalid_argument "<name>:<line>: ..." for the first line that cannot be read.
  void append(std::vector<ObjFragment> fragments, double share, int threads);

  /// @throws std::invalid_argument for indices that point past the file's end, and for a source
  ///   without vertices or faces.
  ObjScene finish();

  const ObjCounts& counts() const { return counts_; }

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
  void resolve(ObjFragment& fragment) const;
  void append_forward(const ObjFragment& fragment);
  void take(ObjFragment& fragment);

  std::string name_;
  ObjScene scene_;
  /// Of what was taken, ahead of the scene's arrays while fragments are added.
  ObjCounts counts_;
  int64_t corner_count_ = 0;
  int32_t face_count_ = 0;
  NameTable groups_;
  NameTable materials_;
  FaceRun run_;
  int64_t line_count_ = 1;
  std::vector<ForwardIndex> forward_[3];
};

}  // namespace snowbough::tree
