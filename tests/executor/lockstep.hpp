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

/// Runs `here`, then `there` from the memory before it. The memory is that of `there` afterwards, of `here` where they differ.
/// @return where and by what they do, in words; empty where they agree in every bit, NaN as one value.
std::string difference(const Allocations& memory, const std::function<void()>& here,
                       const std::function<void()>& there);

}  // namespace bb::test
