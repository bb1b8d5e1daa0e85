#include "core/exec/cuda/copy_rates.hpp"

#include <algorithm>
#include <chrono>
#include <functional>

#include "core/exec/buffer.hpp"

namespace bb::cuda {
namespace {

/// Seconds of one call, the median of `repeats` once calls have been made for `warm_s`: a card that did nothing has low clocks.
double seconds(exec::Executor& executor, int repeats, double warm_s, const std::function<void()>& call) {
  using Clock = std::chrono::steady_clock;
  const auto timed = [&] {
    const Clock::time_point begin = Clock::now();
    call();
    executor.synchronize();
    return std::chrono::duration<double>(Clock::now() - begin).count();
  };
  for (double spent = timed(); spent < warm_s;) spent += timed();
  std::vector<double> each(static_cast<std::size_t>(repeats));
  std::generate(each.begin(), each.end(), timed);
  const auto middle = each.begin() + repeats / 2;
  std::nth_element(each.begin(), middle, each.end());
  return *middle;
}

}  // namespace

CopyRates measure_copies(exec::Executor& executor, std::size_t bytes, double warm_s) {
  const auto n = static_cast<exec::Index>(bytes);
  exec::Buffer<unsigned char> from(executor, "bandwidth test", n), to(executor, "bandwidth test", n);
  from.fill_zero();
  const double size = static_cast<double>(bytes);
  CopyRates rates;
  rates.bytes = bytes;
  rates.copy =
      2 * size / seconds(executor, 21, warm_s, [&] { executor.copy(to.data(), from.data(), bytes); });
  std::vector<unsigned char> here(bytes, 1);
  rates.upload = size / seconds(executor, 3, 0, [&] { executor.upload(to.data(), here.data(), bytes); });
  rates.download = size / seconds(executor, 3, 0, [&] { executor.download(here.data(), to.data(), bytes); });
  return rates;
}

}  // namespace bb::cuda
