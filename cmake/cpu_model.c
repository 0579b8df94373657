// SPDX-License-Identifier: GPL-3.0-or-later
// The two names by which functions compiled with `target_clones` ask for the processor, as in libgcc and compiler-rt.
// Only AVX2 is asked for (SNOWBOUGH_WIDE in base/simd.h).
#include <cpuid.h>

enum { kKnown = 1u, kAvx2 = 1u << 10 };  // of features; kKnown stands for the bit of CMOV, which x86-64 always has

__attribute__((visibility("hidden"))) struct {
  unsigned vendor, type, subtype, features[1];
} __cpu_model;

// AVX2 needs an operating system that saves the upper halves of the registers.
static int saves_wide_registers(void) {
  unsigned a, b, c, d, low, high;
  if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_OSXSAVE) || !(c & bit_AVX)) return 0;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return (low & 6) == 6;
}

__attribute__((visibility("hidden"))) int __cpu_indicator_init(void) {
  unsigned a, b, c, d;
  if (__cpu_model.features[0]) return 0;
  __cpu_model.features[0] = kKnown;
  if (saves_wide_registers() && __get_cpuid_count(7, 0, &a, &b, &c, &d) && (b & bit_AVX2)) {
    __cpu_model.features[0] |= kAvx2;
  }
  return 0;
}
