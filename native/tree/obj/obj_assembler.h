#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "tree/obj/obj_fragment.h"
#include "tree/obj/obj_scene.h"

namespace snowbough::tree {

/// Builds an ObjScene from a file's fragments.
class ObjAssembler {
 public:
  /// @param name name of the source in errors.
  explicit ObjAssembler(std::string name);

  /// Appends the next fragments of the file.
  /// @param share  fraction of the file read so far, 0..1, for reserving memory; 0 = unknown.
  /// @param threads  that share the work, the calling one included; 0 = one per core.
  /// @throws std::invalid_argument "<name>:<line>: ..." for the first line that cannot be read.
  void append(std::vector<ObjFragment> fragments, double share, int threads);

  /// @throws std::invalid_argument for indices beyond the end of the file, and for a source without
  /// vertices or faces.
  ObjScene finish();

  const ObjCounts& counts() const { return counts_; }

 private:
  /// Numbers distinct names in order of appearance.
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
  /// Counts of all appended fragments, ahead of the scene's arrays while fragments are added.
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
