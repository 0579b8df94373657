#pragma once

#include "gpu/program.h"
#include "gpu/resources.h"

// A small program for tests of the classes that run programs.
namespace snowbough::gpu {

/// Data of weighted_rows.comp.glsl: row r is the sum of weight[t] * source[place[t]]
/// over t in [begin[r], begin[r + 1]).
struct WeightedRows {
  const Buffer& begin;
  const Buffer& place;
  const Buffer& weight;
  const Buffer& target_place;
  const Buffer& source;
  const Buffer& target;
};

/// Binds the rows to the program and takes it into use.
inline void use_for(Program& program, const WeightedRows& rows, int32_t count) {
  program.use();
  program.bind("RowBegin", rows.begin);
  program.bind("RowSource", rows.place);
  program.bind("RowWeight", rows.weight);
  program.bind("RowTarget", rows.target_place);
  program.bind("SourceValues", rows.source);
  program.bind("TargetValues", rows.target);
  program.set("count", count);
  program.set("nothing_without_terms", 0);
}

}  // namespace snowbough::gpu
