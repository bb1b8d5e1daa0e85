// The two algorithms of CUB that we call, on integers. One file (library.cu) knows CUB. Both follow its convention: with
// `scratch` null they only set the bytes of scratch memory that they need. All pointers are device memory; the calls
// return before the work is done. @return a cudaError_t; 0 is success
#pragma once

#include "core/exec/kernel.hpp"

struct CUstream_st;

namespace bb::cuda {

/// An array and a second one of its size; a sort leaves its result in array[current].
template <class T>
struct TwoArrays {
  T* array[2];
  int current = 0;
};

/// Ascending by the lowest `bits` bits, stable. values: array[0] null for keys alone.
int sort_by_key(void* scratch, std::size_t& scratch_bytes, TwoArrays<exec::Key>& keys,
                TwoArrays<std::uint32_t>& values, exec::Index n, int bits, CUstream_st* stream);

/// values[i] = first + sum of values[0, i), in place; n below 2^31.
int scan_exclusive(void* scratch, std::size_t& scratch_bytes, exec::Index* values, int n, exec::Index first,
                   CUstream_st* stream);

}  // namespace bb::cuda
