// The block that a machine runs at the moment: its threads, shared memory, what waits for what.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "tests/ptx/fibers.hpp"
#include "tests/ptx/machine.hpp"

namespace ptx {

/// Who touched four bytes of global memory in a launch.
struct Touch {
  static constexpr std::uint32_t nobody = ~0u - 1;
  /// The last thread, or several of its block; loose: somebody of an earlier block was not followed by a fence.
  struct Side {
    std::uint32_t thread = nobody, block = 0, epoch = 0, fences = 0;
    bool loose = false;
  };
  std::uint32_t launch = 0;
  bool atomic = false;  // the writes
  Side read, write;
};

struct Range {
  std::uint64_t begin = 0, end = 0;
  Touch* touches = nullptr;  // one for every four bytes; null of what is only read
  const std::string* name = nullptr;
};

/// Allocations by address. A site of the code tends to find what it found before.
class MemoryMap {
 public:
  void add(std::uint64_t begin, std::uint64_t end, const std::string& name, bool may_be_written);
  void remove(std::uint64_t begin);
  /// The allocation; null when it is none.
  const Range* find(std::uint64_t a, std::uint32_t bytes, int site) {
    const Range& last = last_[static_cast<std::size_t>(site) % last_.size()];
    return a >= last.begin && a + bytes <= last.end ? &last : search(a, bytes, site);
  }

 private:
  const Range* search(std::uint64_t a, std::uint32_t bytes, int site);
  struct Allocation {
    std::uint64_t end;
    std::string name;
    std::vector<Touch> touches;
  };
  std::map<std::uint64_t, Allocation> allocations_;
  std::vector<Range> last_ = std::vector<Range>(256);
};

/// Epochs (1, and one more with every barrier) in which a block had its last fence and its first atomic; 0: none.
struct BlockOrder {
  std::uint32_t last_fence = 0, first_atomic = 0;
};

enum class Use { load, store, atomic };

/// Races between the threads of a launch on global memory (machine_races.cpp). Less than four bytes are not followed.
class RaceWatch {
 public:
  void begin_launch(std::uint32_t blocks, std::uint32_t threads);
  void fence(const Thread& t, std::uint32_t epoch);
  void note_atomic(const Thread& t, std::uint32_t epoch);
  /// Errors: Error, a race.
  void check(const Range& range, const Thread& t, std::uint64_t a, std::uint32_t bytes, Use use,
             std::uint32_t epoch, int line) const;

 private:
  std::uint32_t number(const Thread& t) const { return t.ctaid * threads_ + t.tid; }
  bool is_before(const Touch::Side& side, const Thread& t, std::uint32_t epoch) const;
  void add(Touch::Side& side, const Thread& t, std::uint32_t epoch, bool both_atomic) const;
  bool is_plain(Touch& touch, const Thread& t, Use use, std::uint32_t epoch) const;
  const char* race(Touch& touch, const Thread& t, Use use, std::uint32_t epoch) const;

  std::uint32_t launch_ = 0, threads_ = 0;
  std::vector<BlockOrder> blocks_;
  std::vector<std::uint32_t> fences_;
  std::vector<std::uint8_t> atomics_;
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
  const std::string* buffer;
};

struct Machine::Implementation {
  MemoryMap memory;
  RaceWatch races;
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
  void count_traffic(TrafficOfBuffers& traffic);
};

}  // namespace ptx
