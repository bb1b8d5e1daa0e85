// Four boxes against one: lanes on a host, a loop where nvcc compiles, which knows no vectors. Comparisons and no arithmetic, so
// both say the same.
#pragma once

#include <cstdint>

#include "core/math/host_device.hpp"

#if !defined(__CUDACC__) && defined(__SSE2__)
#include <immintrin.h>
#endif

namespace bb::exec {

/// Siblings of a tree.
constexpr int tree_width = 4;

/// One number of each of four siblings: 16 bytes that a device reads at once.
template <class T>
struct alignas(16) OfSiblings {
  T first, second, third, fourth;
  BB_HD T operator[](int k) const { return k == 0 ? first : k == 1 ? second : k == 2 ? third : fourth; }
  BB_HD void set(int k, T value) { (k == 0 ? first : k == 1 ? second : k == 2 ? third : fourth) = value; }
};

/// Bit k where box k of the four overlaps [a_lo, a_hi] and bit 0 of one of the two tags is set. Clear where a coordinate is NaN.
BB_HD inline unsigned overlapping(const OfSiblings<float> (&lo)[3], const OfSiblings<float> (&hi)[3],
                                  const OfSiblings<std::uint32_t>& tag, const float (&a_lo)[3],
                                  const float (&a_hi)[3], std::uint32_t a_tag) {
#if !defined(__CUDACC__) && defined(__SSE2__)
  const __m128i tags = _mm_or_si128(_mm_loadu_si128(reinterpret_cast<const __m128i*>(&tag)),
                                    _mm_set1_epi32(static_cast<int>(a_tag)));
  __m128 meet = _mm_castsi128_ps(_mm_slli_epi32(tags, 31));  // only the sign is read
  for (int c = 0; c < 3; ++c) {
    meet = _mm_and_ps(meet, _mm_cmple_ps(_mm_set1_ps(a_lo[c]), _mm_loadu_ps(&hi[c].first)));
    meet = _mm_and_ps(meet, _mm_cmple_ps(_mm_loadu_ps(&lo[c].first), _mm_set1_ps(a_hi[c])));
  }
  return static_cast<unsigned>(_mm_movemask_ps(meet));
#else
  const OfSiblings<std::uint32_t> tags = tag;
  OfSiblings<int> meet{1, 1, 1, 1};
  for (int c = 0; c < 3; ++c) {
    const OfSiblings<float> l = lo[c], h = hi[c];
    meet.first &= (a_lo[c] <= h.first) & (l.first <= a_hi[c]);
    meet.second &= (a_lo[c] <= h.second) & (l.second <= a_hi[c]);
    meet.third &= (a_lo[c] <= h.third) & (l.third <= a_hi[c]);
    meet.fourth &= (a_lo[c] <= h.fourth) & (l.fourth <= a_hi[c]);
  }
  unsigned out = 0;
  for (int k = 0; k < tree_width; ++k) out |= ((a_tag | tags[k]) & static_cast<unsigned>(meet[k])) << k;
  return out;
#endif
}

}  // namespace bb::exec
