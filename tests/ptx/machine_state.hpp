// The block that a machine runs at the moment: its threads, shared memory, what waits for what.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "tests/ptx/fibers.hpp"
#include "tests/ptx/machine.hpp"

namespace ptx {

struct Range {
  std::uint64_t begin = 0, end = 0;
};

/// Allocations by address. A site of the code tends to find what it found before.
class MemoryMap {
 public:
  void add(Range range);
  void remove(std::uint64_t begin);
  bool holds(std::uint64_t a, std::uint32_t bytes, int site) {
    const Range& last = last_[static_cast<std::size_t>(site) % last_.size()];
    return (a >= last.begin && a + bytes <= last.end) || search(a, bytes, site);
  }

 private:
  bool search(std::uint64_t a, std::uint32_t bytes, int site);
  std::map<std::uint64_t, std::uint64_t> ranges_;
  std::vector<Range> last_ = std::vector<Range>(256);
};

/// Who touched a byte of shared memory since the last barrier.
struct Shadow {
  static constexpr std::int32_t nobody = -1, many = -2;
  std::uint32_t epoch = 0;
  std::int32_t writer = nobody, reader = nobody;
};

/// Lanes of a warp that meet at a shuffle of one member mask.
struct Meeting {
  std::uint32_t members, arrived = 0, left = 0;
  Thread::Mode mode;
  std::uint32_t values[32];
};

struct Access {
  int line;
  std::uint32_t bytes;
  std::uint64_t address;
};

struct Machine::Implementation {
  MemoryMap memory;
  std::optional<Fibers> fibers;

  // the launch
  Machine* machine = nullptr;
  const Kernel* kernel = nullptr;
  std::vector<Thread> threads;
  // the block
  std::vector<unsigned char> shared;
  std::vector<Shadow> shadow;
  std::uint32_t epoch = 1, at_barrier = 0;
  std::vector<std::deque<Meeting>> meetings;  // by warp
  enum class State { ready, waits_at_barrier, waits_at_shuffle, finished };
  std::vector<State> states;
  std::vector<int> wait_lines;
  std::string error;
  std::vector<std::vector<Access>> accesses;  // by thread, when profiled

  void begin(Machine& of, const Kernel& kernel, const unsigned char* params, std::uint32_t blocks,
             std::uint32_t n_threads);
  void run_block(std::uint32_t number, const std::vector<std::uint32_t>& order);
  void run_fibers(const std::vector<std::uint32_t>& order);
  std::string deadlock() const;
  /// From a thread: until somebody makes it ready.
  void wait(std::uint32_t tid, State state, int line);
  Shadow& shadow_of(std::uint64_t byte);
  void count_traffic(Traffic& traffic);
};

}  // namespace ptx
