#include "core/base/input/memory.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "core/math/error.hpp"

namespace bb {
namespace {

constexpr std::uint64_t unknown = std::numeric_limits<std::uint64_t>::max();

/// "max" and absent files mean no limit.
std::uint64_t number_in(const char* path) {
  std::ifstream in(path);
  std::uint64_t value = 0;
  return in >> value ? value : unknown;
}

std::uint64_t physical() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
  return pages > 0 && page > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page)
                               : unknown;
}

std::uint64_t address_space() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY ? limit.rlim_cur : unknown;
}

std::string in_gib(double bytes) { return fmt::format("{:.3g} GiB", bytes / 0x1p30); }

}  // namespace

std::uint64_t memory_bytes() {
  return std::min({physical(), address_space(), number_in("/sys/fs/cgroup/memory.max"),
                   number_in("/sys/fs/cgroup/memory/memory.limit_in_bytes")});
}

double scene_bytes(const std::vector<MemoryItem>& items) {
  double sum = 0;
  for (const MemoryItem& item : items) sum += item.count * item.bytes_each;
  return sum;
}

void require_memory(const std::string& where, const std::vector<MemoryItem>& items) {
  const double needed = scene_bytes(items), there = static_cast<double>(memory_bytes());
  if (needed <= there) return;
  std::string counts;
  for (const MemoryItem& item : items) counts += fmt::format("{:.0f} {}, ", item.count, item.name);
  throw ConfigError(where, fmt::format("{}which need at least {}", counts, in_gib(needed)),
                    fmt::format("a scene that fits into the {} of this process", in_gib(there)));
}

}  // namespace bb
