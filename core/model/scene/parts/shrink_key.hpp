// How rest lengths of cloth change with time.
#pragma once

#include <vector>

namespace bb {

/// Factor on the rest lengths of a shell at a time.
struct ShrinkKey {
  double time = 0;   // s
  double value = 1;  // > 0
  bool operator==(const ShrinkKey&) const = default;
};

/// Which elements follow which keys.
struct ShrinkSchedule {
  std::vector<int> list;                      // [n] into lists, -1: none; empty: no element has one
  std::vector<std::vector<ShrinkKey>> lists;  // each not empty

  /// Element n - 1 follows these keys; empty: none. Elements before it without an entry follow none.
  void append(std::size_t n, const std::vector<ShrinkKey>& keys) {
    if (keys.empty() && list.empty()) return;
    list.resize(n, -1);
    if (keys.empty()) return;
    if (lists.empty() || lists.back() != keys) lists.push_back(keys);
    list.back() = static_cast<int>(lists.size()) - 1;
  }
};

}  // namespace bb
