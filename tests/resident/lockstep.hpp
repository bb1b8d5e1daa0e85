// A launch twice from the same memory, once compiled by g++ and once in another way (as nvcc's PTX, on a card), and what
// the two leave in all memory compared: a test of a pipeline then also proves, launch by launch, that both agree.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>

namespace bb::test {

/// Begin and bytes of all that is allocated.
using Allocations = std::map<unsigned char*, std::size_t>;

/// Of kernels that call a library (log, atan2): what the numbers of an allocation may differ by, relative to the largest.
inline constexpr double library_tolerance = 1e-13;
/// Whether a kernel calls one, by its name (library_kernels.inc).
bool calls_a_library(const std::string& kernel);

/// Runs `here`, then `there` from the memory before it. The memory is that of `there` afterwards, of `here` where they differ.
/// @return where and by what they do, in words; empty where they agree in every bit, NaN as one value. tolerance: how far
/// the doubles of an allocation may differ, relative to the largest of them.
std::string difference(const Allocations& memory, double tolerance, const std::function<void()>& here,
                       const std::function<void()>& there);

}  // namespace bb::test
