// What an executor knows of a kernel type: its name, its size, and how host threads run a range of it.
#pragma once

#include <string>
#include <type_traits>
#include <typeinfo>

#include "core/exec/kernel.hpp"
#include "core/math/device_code.hpp"

namespace bb::exec {

/// The items or blocks order[begin] to order[end - 1] (order null: begin to end - 1) of the kernel at f, on the calling
/// thread; threads [256]: the order of threads within a block, null: 0, 1, ...
using RunRange = void (*)(const void* f, const Index* order, Index begin, Index end, const int* threads);

struct KernelInfo {
  const std::type_info& type;
  std::size_t bytes;  // of the struct
  bool blocks;        // else each
  RunRange run;
  Index grain = 1;                   // items or blocks that a host thread takes at least, one after the other
  Index lanes = 1;                   // items that a host takes at a time; grain is a multiple of it
  const DeviceCode* code = nullptr;  // of a kernel that no list of the program has; null: the program's own
  /// As C++ writes it: "bb::exec::SpmvDot".
  std::string name() const;
};

/// A kernel over items may have a form for hosts that takes several at a time: `static constexpr int lanes`, and abreast(i),
/// which leaves what items i to i + lanes - 1 leave, bit for bit. Where items are in an order the plain form runs.
template <class F>
concept HasLaneForm = requires(const F& f, Index i) {
  f.abreast(i);
};

/// Of a kernel over items, as KernelInfo has it: 256, or `static constexpr Index grain` of a kernel whose items are dear.
template <class F>
constexpr Index grain_of() {
  if constexpr (requires { F::grain; }) {
    return F::grain;
  } else {
    return 256;
  }
}
template <class F>
constexpr Index lanes_of_kernel() {
  if constexpr (HasLaneForm<F>) {
    return F::lanes;
  } else {
    return 1;
  }
}

namespace detail {
template <class F>
void run_each(const void* f, const Index* order, Index begin, Index end, const int*) {
  const F& kernel = *static_cast<const F*>(f);
  if constexpr (HasLaneForm<F>) {
    if (!order) {
      for (; begin + F::lanes <= end; begin += F::lanes) kernel.abreast(begin);
    }
  }
  for (Index i = begin; i < end; ++i) kernel(order ? order[i] : i);
}
template <class F>
void run_blocks(const void* f, const Index* order, Index begin, Index end, const int* threads) {
  const F& kernel = *static_cast<const F*>(f);
  for (Index i = begin; i < end; ++i) {
    typename F::Shared shared;
    const HostBlock block{threads};
    kernel(block, shared, order ? order[i] : i);
  }
}
}  // namespace detail

template <class F>
const KernelInfo& each_info() {
  static_assert(std::is_trivially_copyable_v<F> && sizeof(F) <= 4000, "a kernel travels as its bytes");
  static_assert(grain_of<F>() % lanes_of_kernel<F>() == 0);
  static const KernelInfo info{typeid(F),     sizeof(F),           false, &detail::run_each<F>,
                               grain_of<F>(), lanes_of_kernel<F>()};
  return info;
}
template <class F>
const KernelInfo& blocks_info() {
  static_assert(std::is_trivially_copyable_v<F> && sizeof(F) <= 4000, "a kernel travels as its bytes");
  static const KernelInfo info{typeid(F), sizeof(F), true, &detail::run_blocks<F>};
  return info;
}

}  // namespace bb::exec
