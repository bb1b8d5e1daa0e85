// What translated PTX (translate.py) is written against: the memory that a thread of a kernel sees, barriers and
// shuffles. Everything is checked: bounds, alignment, races, members of a shuffle, deadlocks. An error names
// the kernel and the line of the PTX.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

namespace ptx {

struct Machine;

/// A region of a thread's local memory; those of the functions that called come behind it.
struct Frame {
  const unsigned char* begin;
  const unsigned char* end;
  Frame* before;
};

struct Thread {
  std::uint32_t tid = 0, ctaid = 0, ntid = 0, nctaid = 0;
  const unsigned char* params = nullptr;
  std::uint32_t param_bytes = 0;
  Machine* machine = nullptr;
  Frame* frames = nullptr;
  std::int64_t fuel = 0;

  // Checked addresses of `bytes` bytes, which is also the alignment. Errors: Error (machine.hpp), all of them.
  const unsigned char* load_global(std::uint64_t a, std::uint32_t bytes, int line);
  unsigned char* store_global(std::uint64_t a, std::uint32_t bytes, int line);
  unsigned char* atomic_global(std::uint64_t a, std::uint32_t bytes, int line);
  /// Address in the shared memory of the block, from 0.
  const unsigned char* load_shared(std::uint64_t a, std::uint32_t bytes, int line);
  unsigned char* store_shared(std::uint64_t a, std::uint32_t bytes, int line);
  const unsigned char* load_local(std::uint64_t a, std::uint32_t bytes, int line);
  unsigned char* store_local(std::uint64_t a, std::uint32_t bytes, int line);
  /// Offset in the parameters.
  const unsigned char* load_param(std::uint64_t a, std::uint32_t bytes, int line);
  /// An address of any space.
  const unsigned char* load_generic(std::uint64_t a, std::uint32_t bytes, int line);
  unsigned char* store_generic(std::uint64_t a, std::uint32_t bytes, int line);
  unsigned char* atomic_generic(std::uint64_t a, std::uint32_t bytes, int line);

  void fence();
  void barrier(int line);
  enum Mode { up, down, bfly, idx };
  /// *in_range: the predicate of shfl.
  std::uint32_t shuffle(Mode mode, std::uint32_t value, std::uint32_t b, std::uint32_t c,
                        std::uint32_t members, bool* in_range, int line);
  /// Of a jump backwards.
  void loop(int line) {
    if (--fuel < 0) fail("runs without end", line);
  }
  [[noreturn]] void fail(const char* what, int line) const;
};

/// Local memory of one function; what was not written is NaN.
template <std::size_t N>
struct Local {
  alignas(16) unsigned char bytes[N];
  Thread& thread;
  Frame frame;
  explicit Local(Thread& t) : thread(t), frame{bytes, bytes + N, t.frames} {
    memset(bytes, 0xff, N);
    t.frames = &frame;
  }
  Local(const Local&) = delete;
  ~Local() { thread.frames = frame.before; }
  std::uint64_t base() const { return reinterpret_cast<std::uint64_t>(bytes); }
};

/// Generic addresses of shared memory begin here.
constexpr std::uint64_t shared_window = std::uint64_t{1} << 62;

template <class T>
T get(const unsigned char* p) {
  T v;
  memcpy(&v, p, sizeof v);
  return v;
}
template <class T>
void put(unsigned char* p, T v) {
  memcpy(p, &v, sizeof v);
}

// --- arithmetic that is not an operator of C++
constexpr double f64(std::uint64_t bits) { return std::bit_cast<double>(bits); }
constexpr float f32(std::uint32_t bits) { return std::bit_cast<float>(bits); }
constexpr std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }
constexpr std::uint32_t bits(float x) { return std::bit_cast<std::uint32_t>(x); }

template <class T>
T min_of(T a, T b) {
  if constexpr (std::is_floating_point_v<T>) {
    if (a != a) return b;
    if (b != b) return a;
    if (a == b) return std::signbit(a) ? a : b;
  }
  return a < b ? a : b;
}
template <class T>
T max_of(T a, T b) {
  if constexpr (std::is_floating_point_v<T>) {
    if (a != a) return b;
    if (b != b) return a;
    if (a == b) return std::signbit(a) ? b : a;
  }
  return a > b ? a : b;
}
/// T unsigned.
template <class T>
T shift_left(T a, std::uint32_t n) {
  return n >= 8 * sizeof(T) ? T{0} : static_cast<T>(a << n);
}
/// T signed: arithmetic.
template <class T>
T shift_right(T a, std::uint32_t n) {
  if (n >= 8 * sizeof(T)) return a < 0 ? static_cast<T>(-1) : T{0};
  return static_cast<T>(a >> n);
}
/// The high half of a product.
template <class T>
T mul_hi(T a, T b) {
  using Wide = std::conditional_t<std::is_signed_v<T>, __int128, unsigned __int128>;
  return static_cast<T>((static_cast<Wide>(a) * static_cast<Wide>(b)) >> (8 * sizeof(T)));
}
/// Sum with the carry going in and out.
template <class T>
T add_carry(T a, T b, std::uint32_t in, std::uint32_t& out) {
  const T sum = static_cast<T>(a + b), all = static_cast<T>(sum + in);
  out = static_cast<std::uint32_t>(sum < a) | static_cast<std::uint32_t>(all < sum);
  return all;
}
template <class T>
T sub_borrow(T a, T b, std::uint32_t in, std::uint32_t& out) {
  const T difference = static_cast<T>(a - b), all = static_cast<T>(difference - in);
  out = static_cast<std::uint32_t>(a < b) | static_cast<std::uint32_t>(difference < in);
  return all;
}
/// Float to integer, already rounded: clamped, NaN as PTX has it.
template <class To, class From>
To to_integer(From x) {
  if (x != x)
    return sizeof(To) == 8 || sizeof(From) == 8 ? static_cast<To>(To{1} << (8 * sizeof(To) - 1)) : To{0};
  const auto low = static_cast<From>(std::numeric_limits<To>::min());
  const From high = std::ldexp(From{1}, std::numeric_limits<To>::digits);
  if (x < low) return std::numeric_limits<To>::min();
  if (x >= high) return std::numeric_limits<To>::max();
  return static_cast<To>(x);
}
/// bits [position, position + length) of `into` from the low bits of `from`.
template <class T>
T insert_bits(T from, T into, std::uint32_t position, std::uint32_t length) {
  position &= 255, length &= 255;
  const T ones = length >= 8 * sizeof(T) ? static_cast<T>(~T{0}) : static_cast<T>((T{1} << length) - 1);
  const T mask = shift_left(ones, position);
  return static_cast<T>((into & ~mask) | (shift_left(from, position) & mask));
}
template <class T>
T extract_bits(T a, std::uint32_t position, std::uint32_t length) {
  using U = std::make_unsigned_t<T>;
  constexpr std::uint32_t width = 8 * sizeof(T);
  position &= 255, length &= 255;
  if (length == 0) return 0;
  const std::uint32_t last = position + length - 1 < width ? position + length - 1 : width - 1;
  const U kept = position >= width ? U{0} : static_cast<U>(static_cast<U>(a) >> position);
  const U mask = length >= width ? static_cast<U>(~U{0}) : static_cast<U>((U{1} << length) - 1);
  const bool negative = std::is_signed_v<T> && (static_cast<U>(a) >> last & 1);
  return static_cast<T>((kept & mask) | (negative ? static_cast<U>(~mask) : U{0}));
}
/// The bytes of b:a that the nibbles of `pick` name.
inline std::uint32_t permute(std::uint32_t a, std::uint32_t b, std::uint32_t pick) {
  const std::uint64_t both = std::uint64_t{b} << 32 | a;
  std::uint32_t out = 0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t n = pick >> (4 * i) & 15;
    const auto byte = static_cast<std::uint32_t>(both >> (8 * (n & 7)) & 255);
    out |= (n & 8 ? (byte & 128 ? 255u : 0u) : byte) << (8 * i);
  }
  return out;
}
/// The seeds of Newton's iterations in nvcc's division, logarithm and roots. The device looks at and returns the upper
/// 32 bits; which of their last bits are right is its own affair.
inline double upper(double x) { return f64(bits(x) & ~std::uint64_t{0xffffffff}); }
inline double rcp_approx(double x) { return upper(1 / upper(x)); }
inline double rsqrt_approx(double x) { return upper(1 / std::sqrt(upper(x))); }

/// a + b, a * b and fma with another direction of rounding (FE_TOWARDZERO, ...); T is float or double.
template <class T>
T add_directed(T a, T b, int direction);
template <class T>
T mul_directed(T a, T b, int direction);
template <class T>
T fma_directed(T a, T b, T c, int direction);
double to_double_directed(std::int64_t a, int direction);

}  // namespace ptx
