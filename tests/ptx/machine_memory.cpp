// What a thread may touch: global memory within allocations, shared memory without races, its own local memory.
#include "tests/ptx/machine_state.hpp"

namespace ptx {

void MemoryMap::add(std::uint64_t begin, std::uint64_t end, const std::string& name, bool may_be_written) {
  allocations_[begin] = {end, name, std::vector<Touch>(may_be_written ? (end - begin + 3) / 4 : 0)};
}
void MemoryMap::remove(std::uint64_t begin) {
  allocations_.erase(begin);
  for (Range& range : last_) {
    if (range.begin == begin) range = {};
  }
}
const Range* MemoryMap::search(std::uint64_t a, std::uint32_t bytes, int site) {
  auto it = allocations_.upper_bound(a);
  if (it == allocations_.begin()) return nullptr;
  --it;
  if (a + bytes > it->second.end) return nullptr;
  Touch* touches = it->second.touches.empty() ? nullptr : it->second.touches.data();
  return &(last_[static_cast<std::size_t>(site) % last_.size()] = {it->first, it->second.end, touches,
                                                                   &it->second.name});
}

void Thread::fail(const char* what, int line) const {
  throw Error(demangled(machine->all->kernel->name) + ": " + what + " at PTX line " + std::to_string(line) +
              ", thread " + std::to_string(tid) + " of block " + std::to_string(ctaid));
}

namespace {
unsigned char* global(Thread& t, std::uint64_t a, std::uint32_t bytes, Use use, int line) {
  if (a % bytes != 0) t.fail("misaligned access to global memory", line);
  Machine::Implementation& all = *t.machine->all;
  const Range* range = all.memory.find(a, bytes, line);
  if (!range)
    t.fail(use == Use::load ? "a load outside all allocations" : "a store outside all allocations", line);
  if (use != Use::load && !range->touches) t.fail("a store to a table of constants", line);
  all.races.check(*range, t, a, bytes, use, all.epoch, line);
  if (t.machine->profile) all.accesses[t.tid].push_back({line, bytes, a, range->name});
  return reinterpret_cast<unsigned char*>(a);
}
void check_shared(const Thread& t, std::uint64_t a, std::uint32_t bytes, int line) {
  if (a % bytes != 0) t.fail("misaligned access to shared memory", line);
  if (a + bytes > t.machine->all->shared.size()) t.fail("shared memory out of bounds", line);
}
bool is_local(const Thread& t, std::uint64_t a, std::uint32_t bytes) {
  for (const Frame* f = t.frames; f; f = f->before) {
    if (a >= reinterpret_cast<std::uint64_t>(f->begin) &&
        a + bytes <= reinterpret_cast<std::uint64_t>(f->end)) {
      return true;
    }
  }
  return false;
}
unsigned char* local(const Thread& t, std::uint64_t a, std::uint32_t bytes, int line) {
  if (a % bytes != 0) t.fail("misaligned access to local memory", line);
  if (!is_local(t, a, bytes)) t.fail("local memory out of bounds", line);
  return reinterpret_cast<unsigned char*>(a);
}
}  // namespace

const unsigned char* Thread::load_global(std::uint64_t a, std::uint32_t bytes, int line) {
  return global(*this, a, bytes, Use::load, line);
}
unsigned char* Thread::store_global(std::uint64_t a, std::uint32_t bytes, int line) {
  return global(*this, a, bytes, Use::store, line);
}
unsigned char* Thread::atomic_global(std::uint64_t a, std::uint32_t bytes, int line) {
  unsigned char* place = global(*this, a, bytes, Use::atomic, line);
  machine->all->races.note_atomic(*this, machine->all->epoch);
  return place;
}
void Thread::fence() { machine->all->races.fence(*this, machine->all->epoch); }

Shadow& Machine::Implementation::shadow_of(std::uint64_t byte) {
  Shadow& s = shadow[byte];
  if (s.epoch != epoch) s = {epoch, Shadow::nobody, Shadow::nobody};
  return s;
}
const unsigned char* Thread::load_shared(std::uint64_t a, std::uint32_t bytes, int line) {
  check_shared(*this, a, bytes, line);
  Machine::Implementation& all = *machine->all;
  const auto me = static_cast<std::int32_t>(tid);
  for (std::uint64_t b = a; b < a + bytes; ++b) {
    Shadow& s = all.shadow_of(b);
    if (s.writer != Shadow::nobody && s.writer != me) {
      fail("race: reads shared memory that another thread wrote since the last barrier", line);
    }
    s.reader = s.reader == Shadow::nobody || s.reader == me ? me : Shadow::many;
  }
  return all.shared.data() + a;
}
unsigned char* Thread::store_shared(std::uint64_t a, std::uint32_t bytes, int line) {
  check_shared(*this, a, bytes, line);
  Machine::Implementation& all = *machine->all;
  const auto me = static_cast<std::int32_t>(tid);
  for (std::uint64_t b = a; b < a + bytes; ++b) {
    Shadow& s = all.shadow_of(b);
    if ((s.writer != Shadow::nobody && s.writer != me) || (s.reader != Shadow::nobody && s.reader != me)) {
      fail("race: writes shared memory that another thread touched since the last barrier", line);
    }
    s.writer = me;
  }
  return all.shared.data() + a;
}

const unsigned char* Thread::load_local(std::uint64_t a, std::uint32_t bytes, int line) {
  return local(*this, a, bytes, line);
}
unsigned char* Thread::store_local(std::uint64_t a, std::uint32_t bytes, int line) {
  return local(*this, a, bytes, line);
}
const unsigned char* Thread::load_param(std::uint64_t a, std::uint32_t bytes, int line) {
  if (a % bytes != 0 || a + bytes > param_bytes) fail("parameters out of bounds", line);
  return params + a;
}

const unsigned char* Thread::load_generic(std::uint64_t a, std::uint32_t bytes, int line) {
  if (a >= shared_window) return load_shared(a - shared_window, bytes, line);
  const auto begin = reinterpret_cast<std::uint64_t>(params);
  if (a >= begin && a + bytes <= begin + param_bytes) return reinterpret_cast<const unsigned char*>(a);
  return is_local(*this, a, bytes) ? load_local(a, bytes, line) : load_global(a, bytes, line);
}
unsigned char* Thread::atomic_generic(std::uint64_t a, std::uint32_t bytes, int line) {
  if (a >= shared_window || is_local(*this, a, bytes)) fail("an atomic outside of global memory", line);
  return atomic_global(a, bytes, line);
}
unsigned char* Thread::store_generic(std::uint64_t a, std::uint32_t bytes, int line) {
  if (a >= shared_window) return store_shared(a - shared_window, bytes, line);
  return is_local(*this, a, bytes) ? store_local(a, bytes, line) : store_global(a, bytes, line);
}

}  // namespace ptx
