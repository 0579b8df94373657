#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace snowbough::base {

/// Groups values by their keys, each group in the order in which its values come.
///
/// @param keys  number of keys, from 0 on.
/// @param for_each  for_each(visit) calls visit(key, value) for every value. It is called twice and
///   must do the same.
/// @param begin  group k is values[begin[k]] to before values[begin[k + 1]].
template <typename ForEach, typename Index, typename Value>
void group_by_key(size_t keys, const ForEach& for_each, std::vector<Index>& begin,
                  std::vector<Value>& values) {
  begin.assign(keys + 1, 0);
  for_each([&](auto key, const Value&) { ++begin[static_cast<size_t>(key) + 1]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  values.resize(static_cast<size_t>(begin.back()));
  std::vector<Index> next(begin.begin(), begin.end() - 1);
  for_each([&](auto key, const Value& value) { values[next[static_cast<size_t>(key)]++] = value; });
}

}  // namespace snowbough::base
