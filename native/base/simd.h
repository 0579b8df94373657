#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

/// Marks a function whose loops gain from wide registers: it is compiled for AVX-512, AVX2 and the
/// baseline, and chosen at run time. Without fused multiply-add all give the same bits.
/// cmake/Bundled.cmake defines SNOWBOUGH_CLONES for Clang.
#if (defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
     !defined(__SANITIZE_ADDRESS__)) ||                                 \
    defined(SNOWBOUGH_CLONES)
#define SNOWBOUGH_WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define SNOWBOUGH_WIDE
#endif

/// The same for an inner loop, with everything that it calls inlined. Clang does not take `flatten`
/// beside `target_clones`: the packages raise its limit for inlining instead.
#ifdef SNOWBOUGH_CLONES
#define SNOWBOUGH_WIDE_FLAT SNOWBOUGH_WIDE
#else
#define SNOWBOUGH_WIDE_FLAT SNOWBOUGH_WIDE __attribute__((flatten))
#endif

namespace snowbough::base {

/// Four numbers with element-wise arithmetic, comparison (-1 for true, else 0) and `mask ? a : b`:
/// a vector type of GCC and Clang.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int32_t __attribute__((vector_size(16)));

// Intrinsics: the compiler's code for the portable form takes several times as long.

/// The lanes rotated by one: b, c, d, a.
template <typename Four>
Four rotated(const Four& v) {
  return __builtin_shufflevector(v, v, 1, 2, 3, 0);
}

/// All lanes the same.
inline Float4 four(float value) {
  return Float4{} + value;
}

/// Element-wise maximum; returns b if either is NaN.
inline Float4 larger(const Float4& a, const Float4& b) {
#ifdef __SSE2__
  return __builtin_ia32_maxps(a, b);
#else
  return a > b ? a : b;
#endif
}

inline Float4 smaller(const Float4& a, const Float4& b) {
#ifdef __SSE2__
  return __builtin_ia32_minps(a, b);
#else
  return a < b ? a : b;
#endif
}

inline float largest(const Float4& v) {
  const float low = v[0] > v[1] ? v[0] : v[1];
  const float high = v[2] > v[3] ? v[2] : v[3];
  return low > high ? low : high;
}

inline float smallest(const Float4& v) {
  const float low = v[0] < v[1] ? v[0] : v[1];
  const float high = v[2] < v[3] ? v[2] : v[3];
  return low < high ? low : high;
}

/// For lanes that are not negative.
inline Float4 square_root(const Float4& v) {
#ifdef __SSE2__
  return _mm_sqrt_ps(v);
#else
  Float4 root{};
  for (int k = 0; k < 4; ++k) root[k] = std::sqrt(v[k]);
  return root;
#endif
}

/// Bit k is set if the comparison holds in lane k.
inline uint32_t bits(const Int4& mask) {
#ifdef __SSE2__
  return static_cast<uint32_t>(__builtin_ia32_movmskps(std::bit_cast<Float4>(mask)));
#else
  return static_cast<uint32_t>((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
#endif
}

}  // namespace snowbough::base
