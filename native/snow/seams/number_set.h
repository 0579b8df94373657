#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace snowbough::snow {

/// A bit set of numbers from 0: inserting many and reading them in order is faster than sorting.
class NumberSet {
 public:
  /// For numbers below `count`.
  void resize(size_t count) { words_.resize(count / 64 + 1, 0); }
  void add(int32_t number) {
    words_[static_cast<size_t>(number) / 64] |= uint64_t{1} << (number % 64);
  }
  /// Moves all numbers to `numbers`, ascending.
  void take(std::vector<int32_t>& numbers) {
    numbers.clear();
    for (size_t word = 0; word < words_.size(); ++word) {
      uint64_t bits = words_[word];
      if (bits == 0) continue;
      words_[word] = 0;
      for (; bits != 0; bits &= bits - 1) {
        numbers.push_back(static_cast<int32_t>(word * 64) + std::countr_zero(bits));
      }
    }
  }

 private:
  std::vector<uint64_t> words_;
};

}  // namespace snowbough::snow
