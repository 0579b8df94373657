#pragma once

// For inner loops: two builds, chosen at run time; without fused multiply-add both give the same
// bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define SNOWBOUGH_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define SNOWBOUGH_WIDE
#endif
