// Races on global memory within one launch. Blocks run one after another here, on a card at the same time: two threads
// that touch a word, one of them writing, need a barrier of their block between them, or a fence behind the first and
// an atomic before the second (the last block that adds up what all wrote). Whoever waits for neither is named.
#include "tests/ptx/machine_state.hpp"

namespace ptx {

namespace {
constexpr std::uint32_t several = ~0u;

/// A fence of its own thread, or of one of its block behind a barrier, came after the touch.
bool is_released(const Touch::Side& side, const std::vector<BlockOrder>& blocks,
                 const std::vector<std::uint32_t>& fences) {
  if (side.loose) return false;
  if (side.thread != several && fences[side.thread] > side.fences) return true;
  return side.epoch < blocks[side.block].last_fence;
}
}  // namespace

void RaceWatch::begin_launch(std::uint32_t blocks, std::uint32_t threads) {
  ++launch_;
  threads_ = threads;
  blocks_.assign(blocks, {});
  fences_.assign(std::size_t{blocks} * threads, 0);
  atomics_.assign(std::size_t{blocks} * threads, 0);
}

void RaceWatch::fence(const Thread& t, std::uint32_t epoch) {
  ++fences_[number(t)];
  blocks_[t.ctaid].last_fence = epoch;
}

void RaceWatch::note_atomic(const Thread& t, std::uint32_t epoch) {
  atomics_[number(t)] = 1;
  BlockOrder& block = blocks_[t.ctaid];
  if (block.first_atomic == 0) block.first_atomic = epoch;
}

bool RaceWatch::is_before(const Touch::Side& side, const Thread& t, std::uint32_t epoch) const {
  if (side.thread == Touch::nobody || (side.thread == number(t) && !side.loose)) return true;
  if (side.block == t.ctaid && !side.loose && side.epoch < epoch) return true;
  const BlockOrder& mine = blocks_[t.ctaid];
  const bool acquired = atomics_[number(t)] != 0 || (mine.first_atomic != 0 && mine.first_atomic < epoch);
  return acquired && is_released(side, blocks_, fences_);
}

// Atomics order each other: those before are not lost sight of.
void RaceWatch::add(Touch::Side& side, const Thread& t, std::uint32_t epoch, bool both_atomic) const {
  const std::uint32_t me = number(t);
  if (side.thread == Touch::nobody || side.thread == me) {
    side = {me, t.ctaid, epoch, fences_[me], side.loose};
    return;
  }
  const bool loose = !both_atomic && side.block != t.ctaid && !is_released(side, blocks_, fences_);
  const bool one_before = side.block != t.ctaid || side.epoch < epoch;
  side = {one_before ? me : several, t.ctaid, epoch, fences_[me], side.loose || loose};
}

// What most accesses are: the first of a launch, or one more load of what nobody writes.
bool RaceWatch::is_plain(Touch& touch, const Thread& t, Use use, std::uint32_t epoch) const {
  const std::uint32_t me = number(t);
  if (touch.launch != launch_) {
    touch = {launch_, use == Use::atomic, {}, {}};
    (use == Use::load ? touch.read : touch.write) = {me, t.ctaid, epoch, fences_[me], false};
    return true;
  }
  Touch::Side& read = touch.read;
  if (use != Use::load || touch.write.thread != Touch::nobody || read.block != t.ctaid || read.epoch != epoch)
    return false;
  read.thread = read.thread == me ? me : several;
  read.fences = fences_[me];
  return true;
}

const char* RaceWatch::race(Touch& touch, const Thread& t, Use use, std::uint32_t epoch) const {
  const bool writes = use != Use::load, both_atomic = use == Use::atomic && touch.atomic;
  if (!both_atomic && !is_before(touch.write, t, epoch)) {
    return writes ? "race: writes global memory that another thread wrote in this launch"
                  : "race: reads global memory that another thread wrote in this launch";
  }
  if (writes && !is_before(touch.read, t, epoch))
    return "race: writes global memory that another thread read in this launch";
  if (writes) touch.atomic = use == Use::atomic && (both_atomic || touch.write.thread == Touch::nobody);
  add(writes ? touch.write : touch.read, t, epoch, both_atomic);
  return nullptr;
}

void RaceWatch::check(const Range& range, const Thread& t, std::uint64_t a, std::uint32_t bytes, Use use,
                      std::uint32_t epoch, int line) const {
  if (bytes < 4 || !range.touches) return;
  for (std::uint64_t word = (a - range.begin) / 4; word < (a + bytes - range.begin) / 4; ++word) {
    Touch& touch = range.touches[word];
    if (is_plain(touch, t, use, epoch)) continue;
    if (const char* what = race(touch, t, use, epoch)) t.fail(what, line);
  }
}

}  // namespace ptx
