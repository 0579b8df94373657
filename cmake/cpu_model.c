// SPDX-License-Identifier: GPL-3.0-or-later
// The two names by which functions compiled with `target_clones` ask for the processor, as in libgcc and compiler-rt.
// Only AVX2 and AVX-512's foundation are asked for (SNOWBOUGH_WIDE in base/simd.h).
#include <cpuid.h>

// Of features; kKnown stands for the bit of CMOV, which x86-64 always has.
enum { kKnown = 1u, kAvx2 = 1u << 10, kAvx512 = 1u << 15 };

__attribute__((visibility("hidden"))) struct {
  unsigned vendor, type, subtype, features[1];
} __cpu_model;

// Wide registers need an operating system that saves them: bits 1 and 2 for AVX2, also 5 to 7 for AVX-512.
static int saves_registers(unsigned bits) {
  unsigned a, b, c, d, low, high;
  if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_OSXSAVE) || !(c & bit_AVX)) return 0;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return (low & bits) == bits;
}

__attribute__((visibility("hidden"))) int __cpu_indicator_init(void) {
  unsigned a, b, c, d;
  if (__cpu_model.features[0]) return 0;
  __cpu_model.features[0] = kKnown;
  if (!__get_cpuid_count(7, 0, &a, &b, &c, &d)) return 0;
  if ((b & bit_AVX2) && saves_registers(0x06)) __cpu_model.features[0] |= kAvx2;
  if ((b & bit_AVX512F) && saves_registers(0xE6)) __cpu_model.features[0] |= kAvx512;
  return 0;
}
