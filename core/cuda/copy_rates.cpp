#include "core/cuda/copy_rates.hpp"

#include <chrono>
#include <functional>

#include "core/exec/buffer.hpp"

namespace bb::cuda {
namespace {

/// Seconds of one call, the mean of `repeats` after one that is not counted.
double seconds(exec::Executor& executor, int repeats, const std::function<void()>& call) {
  using Clock = std::chrono::steady_clock;
  call();
  executor.synchronize();
  const Clock::time_point begin = Clock::now();
  for (int i = 0; i < repeats; ++i) call();
  executor.synchronize();
  return std::chrono::duration<double>(Clock::now() - begin).count() / repeats;
}

}  // namespace

CopyRates measure_copies(exec::Executor& executor, std::size_t bytes) {
  const auto n = static_cast<exec::Index>(bytes);
  exec::Buffer<unsigned char> from(executor, "bandwidth test", n), to(executor, "bandwidth test", n);
  from.fill_zero();
  const double size = static_cast<double>(bytes);
  CopyRates rates;
  rates.bytes = bytes;
  rates.copy = 2 * size / seconds(executor, 20, [&] { executor.copy(to.data(), from.data(), bytes); });
  std::vector<unsigned char> here(bytes, 1);
  rates.upload = size / seconds(executor, 3, [&] { executor.upload(to.data(), here.data(), bytes); });
  rates.download = size / seconds(executor, 3, [&] { executor.download(here.data(), to.data(), bytes); });
  return rates;
}

}  // namespace bb::cuda
