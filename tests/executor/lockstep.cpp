#include "tests/executor/lockstep.hpp"

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

namespace bb::test {
namespace {

using Memory = std::vector<std::vector<unsigned char>>;

Memory copy_of(const Allocations& allocations) {
  Memory out;
  for (const auto& [begin, bytes] : allocations) out.emplace_back(begin, begin + bytes);
  return out;
}
void restore(const Allocations& allocations, const Memory& values) {
  std::size_t i = 0;
  for (const auto& [begin, bytes] : allocations) std::memcpy(begin, values[i++].data(), bytes);
}

double number(const unsigned char* p) {
  double x;
  std::memcpy(&x, p, sizeof x);
  return x;
}

/// Two floats, each the same or on both sides what an operation without a number leaves: the processor sets one bit of such a
/// NaN, and a negation its sign; a card sets all bits but the sign.
bool same_floats(const unsigned char* a, const unsigned char* b) {
  constexpr std::uint32_t sign = 0x80000000, of_host = 0x7fc00000, of_card = 0x7fffffff;
  for (std::size_t k = 0; k < 8; k += 4) {
    std::uint32_t x, y;
    std::memcpy(&x, a + k, sizeof x), std::memcpy(&y, b + k, sizeof y);
    if (x != y && !((x & ~sign) == of_host && y == of_card)) return false;
  }
  return true;
}

/// What an operation without a number leaves on the processor or on a card, and memory that was never written. Two integers
/// side by side are seldom one of these.
bool is_no_number(const unsigned char* p) {
  std::uint64_t bits;
  std::memcpy(&bits, p, sizeof bits);
  const std::uint64_t size = bits & ~(std::uint64_t{1} << 63);
  return size == 0x7ff8000000000000 || size == 0x7fffffffffffffff;
}

/// Doubles with the same bits, NaN as one value. False for anything else.
bool same_numbers(const unsigned char* a, const unsigned char* b, std::size_t bytes) {
  if (bytes % 8 != 0) return false;
  for (std::size_t k = 0; k < bytes; k += 8) {
    if (!same_floats(a + k, b + k) && !(is_no_number(a + k) && is_no_number(b + k))) return false;
  }
  return true;
}

std::string where(const unsigned char* expected, const unsigned char* found, std::size_t bytes) {
  std::size_t k = 0;
  while (expected[k] == found[k]) ++k;
  k -= k % 8;
  char text[160] = "";
  if (k + 8 <= bytes) {
    std::snprintf(text, sizeof text, ", as doubles %.17g and %.17g", number(expected + k), number(found + k));
  }
  return "host and device differ at byte " + std::to_string(k) + " of " + std::to_string(bytes) + text;
}

}  // namespace

std::string difference(const Allocations& memory, const std::function<void()>& here,
                       const std::function<void()>& there) {
  const Memory before = copy_of(memory);
  here();
  const Memory host = copy_of(memory);
  restore(memory, before);
  there();
  std::size_t i = 0;
  for (const auto& [found, bytes] : memory) {
    const unsigned char* expected = host[i++].data();
    if (bytes == 0 || std::memcmp(expected, found, bytes) == 0) continue;
    if (same_numbers(expected, found, bytes)) continue;
    const std::string text = where(expected, found, bytes);
    restore(memory, host);
    return text;
  }
  return "";
}

}  // namespace bb::test
