#include "tests/ptx/lockstep_executor.hpp"

#include <algorithm>
#include <cstdio>

namespace ptx {

using Memory = std::vector<std::vector<unsigned char>>;

namespace {
Memory copy_of(const std::map<unsigned char*, std::size_t>& allocations) {
  Memory out;
  for (const auto& [begin, bytes] : allocations) out.emplace_back(begin, begin + bytes);
  return out;
}
void restore(const std::map<unsigned char*, std::size_t>& allocations, const Memory& values) {
  std::size_t i = 0;
  for (const auto& [begin, bytes] : allocations) memcpy(begin, values[i++].data(), bytes);
}

double number(const unsigned char* p) {
  double x;
  memcpy(&x, p, sizeof x);
  return x;
}
/// Doubles that agree up to the tolerance. False for anything else.
bool near(const unsigned char* a, const unsigned char* b, std::size_t bytes, double tolerance) {
  if (bytes % 8 != 0) return false;
  double largest = 0, worst = 0;
  for (std::size_t k = 0; k < bytes; k += 8) {
    const double x = number(a + k), y = number(b + k);
    if (memcmp(a + k, b + k, 8) == 0 || (std::isnan(x) && std::isnan(y))) {
      if (std::isfinite(x)) largest = std::max(largest, std::fabs(x));
      continue;
    }
    if (!std::isfinite(x) || !std::isfinite(y)) return false;
    largest = std::max(largest, std::fabs(x)), worst = std::max(worst, std::fabs(x - y));
  }
  return worst <= tolerance * largest;
}
/// Two NaN are the same, whatever their bits.
bool same(const unsigned char* a, const unsigned char* b, std::size_t bytes) {
  return memcmp(a, b, bytes) == 0 || near(a, b, bytes, 0);
}
}  // namespace

std::vector<std::string>& LockstepExecutor::library_kernels() {
  static std::vector<std::string> names;
  return names;
}

void LockstepExecutor::run(const bb::exec::KernelInfo& kernel, bb::exec::Index n, const void* f) {
  const Memory before = copy_of(allocations());
  HostExecutor::run(kernel, n, f);
  const Memory host = copy_of(allocations());
  restore(allocations(), before);
  PtxExecutor::run(kernel, n, f);
  const std::string name = kernel.name();
  const bool library =
      std::any_of(library_kernels().begin(), library_kernels().end(),
                  [&](const std::string& part) { return name.find(part) != std::string::npos; });
  std::size_t i = 0;
  for (const auto& [device, bytes] : allocations()) {
    const unsigned char* expected = host[i++].data();
    if (same(expected, device, bytes) || (library && near(expected, device, bytes, library_tolerance)))
      continue;
    std::size_t k = 0;
    while (expected[k] == device[k]) ++k;
    k -= k % 8;
    char text[160] = "";
    if (k + 8 <= bytes) {
      std::snprintf(text, sizeof text, ", as doubles %.17g and %.17g", number(expected + k),
                    number(device + k));
    }
    throw bb::exec::ExecutionError(name + ": host and device differ at byte " + std::to_string(k) + " of " +
                                   std::to_string(bytes) + text);
  }
}

}  // namespace ptx
