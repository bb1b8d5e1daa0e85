// One block of a launch: its threads one after another, or as fibers where they wait for each other.
#include <algorithm>
#include <set>

#include "tests/ptx/machine_state.hpp"

namespace ptx {

namespace {
constexpr std::int64_t most_jumps = 200'000'000;  // backwards, of one thread
constexpr std::size_t most_threads = 256;
}  // namespace

void Machine::Implementation::begin(Machine& of, const Kernel& k, const unsigned char* params,
                                    std::uint32_t blocks, std::uint32_t n_threads) {
  machine = &of, kernel = &k;
  threads.resize(n_threads), states.resize(n_threads), wait_lines.resize(n_threads);
  accesses.resize(n_threads);
  races.begin_launch(blocks, n_threads);
  for (std::uint32_t t = 0; t < n_threads; ++t) {
    threads[t] = {t, 0, n_threads, blocks, params, k.param_bytes, &of, nullptr, 0};
  }
}

void Machine::Implementation::run_block(std::uint32_t number, const std::vector<std::uint32_t>& order) {
  shared.assign(kernel->shared_bytes, 0xff);  // NaN
  shadow.assign(kernel->shared_bytes, {});
  epoch = 1, at_barrier = 0, error.clear();
  for (Thread& t : threads) t.ctaid = number, t.frames = nullptr, t.fuel = most_jumps;
  for (auto& list : accesses) list.clear();
  if (kernel->synchronizes) return run_fibers(order);
  for (const std::uint32_t t : order) kernel->run(threads[t]);
}

void Machine::Implementation::run_fibers(const std::vector<std::uint32_t>& order) {
  if (threads.size() > most_threads) throw Error("blocks of more than 256 threads that wait for each other");
  if (!fibers) fibers.emplace(most_threads);
  meetings.assign((threads.size() + 31) / 32, {});
  std::fill(states.begin(), states.end(), State::ready);
  const auto body = [](void* argument) {
    Thread& t = *static_cast<Thread*>(argument);
    Implementation& all = *t.machine->all;
    try {
      all.kernel->run(t);
    } catch (const std::exception& e) {
      if (all.error.empty()) all.error = e.what();
    }
    all.states[t.tid] = State::finished;
    all.fibers->yield();
  };
  for (std::uint32_t t = 0; t < threads.size(); ++t) fibers->start(t, body, &threads[t]);
  for (bool moved = true; moved;) {
    moved = false;
    for (const std::uint32_t t : order) {
      if (states[t] != State::ready) continue;
      moved = true;
      fibers->resume(t);
      if (!error.empty()) throw Error(error);
    }
  }
  const auto ended = std::count(states.begin(), states.end(), State::finished);
  if (static_cast<std::size_t>(ended) != threads.size()) throw Error(deadlock());
}

void Machine::Implementation::wait(std::uint32_t tid, State state, int line) {
  states[tid] = state, wait_lines[tid] = line;
  fibers->yield();
}

std::string Machine::Implementation::deadlock() const {
  std::map<std::string, int> waiting;
  for (std::size_t t = 0; t < states.size(); ++t) {
    const std::string at = " of PTX line " + std::to_string(wait_lines[t]);
    if (states[t] == State::waits_at_barrier) ++waiting["at the barrier" + at];
    if (states[t] == State::waits_at_shuffle) ++waiting["at the shuffle" + at];
    if (states[t] == State::finished) ++waiting["have ended"];
  }
  std::string out = demangled(kernel->name) + ": deadlock:";
  for (const auto& [where, n] : waiting) out += " " + std::to_string(n) + " threads " + where + ",";
  out.pop_back();
  return out;
}

void Thread::barrier(int line) {
  Machine::Implementation& all = *machine->all;
  if (++all.at_barrier < ntid) return all.wait(tid, Machine::Implementation::State::waits_at_barrier, line);
  all.at_barrier = 0, ++all.epoch;
  std::fill(all.states.begin(), all.states.end(), Machine::Implementation::State::ready);
}

std::uint32_t Thread::shuffle(Mode mode, std::uint32_t value, std::uint32_t b, std::uint32_t c,
                              std::uint32_t members, bool* in_range, int line) {
  using State = Machine::Implementation::State;
  Machine::Implementation& all = *machine->all;
  const std::uint32_t lane = tid % 32, bit = 1u << lane, warp = tid / 32;
  if (!(members & bit)) fail("a shuffle whose members leave out the thread itself", line);
  std::deque<Meeting>& open = all.meetings[warp];
  auto meeting = std::find_if(open.begin(), open.end(),
                              [&](const Meeting& m) { return m.members == members && !(m.arrived & bit); });
  if (meeting == open.end()) meeting = open.insert(open.end(), Meeting{members, 0, 0, mode, {}});
  if (meeting->mode != mode) fail("members of a shuffle meet in different kinds of it", line);
  meeting->values[lane] = value;
  meeting->arrived |= bit;
  if (meeting->arrived != members) {
    all.wait(tid, State::waits_at_shuffle, line);
  } else {
    for (std::uint32_t l = 0; l < 32; ++l) {
      if (members >> l & 1) all.states[32 * warp + l] = State::ready;
    }
  }
  // Positions change when others leave: the oldest complete meeting of these members is ours.
  meeting = std::find_if(open.begin(), open.end(), [&](const Meeting& m) {
    return m.members == members && m.arrived == members && !(m.left & bit);
  });
  const std::uint32_t fixed = c >> 8 & 31, limit = c & 31, first = lane & fixed,
                      last = first | (limit & ~fixed);
  std::uint32_t from = lane;
  b &= 31;
  bool inside = false;
  if (mode == up)
    from = lane - b, inside = static_cast<std::int32_t>(from) >= static_cast<std::int32_t>(last);
  if (mode == down) from = lane + b, inside = from <= last;
  if (mode == bfly) from = lane ^ b, inside = from <= last;
  if (mode == idx) from = first | (b & ~fixed), inside = from <= last;
  if (!inside) from = lane;
  if (!(members >> from & 1)) fail("a shuffle from a thread that is not a member", line);
  if (in_range) *in_range = inside;
  const std::uint32_t result = meeting->values[from];
  meeting->left |= bit;
  if (meeting->left == members) open.erase(meeting);
  return result;
}

namespace {
// Of one request: addresses and bytes of its lanes.
Traffic traffic_of(std::vector<std::pair<std::uint64_t, std::uint32_t>>& lanes) {
  std::sort(lanes.begin(), lanes.end());
  std::set<std::uint64_t> lines, sectors;
  std::uint64_t bytes = 0, end = 0;
  for (const auto& [address, size] : lanes) {
    lines.insert(address / 128), sectors.insert(address / 32);
    if (address + size > end) bytes += address + size - std::max(address, end), end = address + size;
  }
  return {1, lines.size(), sectors.size(), (bytes + 31) / 32};
}
}  // namespace

// The k-th time that the lanes of a warp come to a line is one request.
void Machine::Implementation::count_traffic(TrafficOfBuffers& traffic) {
  using Site = std::tuple<const std::string*, int, int>;
  for (std::size_t warp = 0; 32 * warp < threads.size(); ++warp) {
    std::map<Site, std::vector<std::pair<std::uint64_t, std::uint32_t>>> requests;
    for (std::size_t t = 32 * warp; t < std::min(threads.size(), 32 * warp + 32); ++t) {
      std::map<int, int> visits;
      for (const Access& a : accesses[t]) {
        requests[{a.buffer, a.line, visits[a.line]++}].emplace_back(a.address, a.bytes);
      }
    }
    for (auto& [site, lanes] : requests) traffic[*std::get<0>(site)].add(traffic_of(lanes));
  }
}

}  // namespace ptx
