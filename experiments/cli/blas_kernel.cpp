#include "core/linear/blas_kernel.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "core/math/error.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/verbs.hpp"

namespace bb::cli {
namespace {

constexpr const char* flag = "--blas-kernel";

/// Returns only when the program could not be started again; why. The program uses one thread of BLAS, but OpenBLAS starts
/// one a core while it is loaded, which wait for work by sched_yield, some 1500 times in a run of one small step.
std::string restart(const std::vector<std::string>& argv) {
  std::vector<char*> pointers;
  for (const std::string& word : argv) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  const char* before = std::getenv("OPENBLAS_CORETYPE");
  ::setenv("OPENBLAS_NUM_THREADS", "1", 1);
  const std::string kept = before != nullptr ? before : "";
  ::setenv("OPENBLAS_CORETYPE", fixed_blas_kernel, 1);
  ::execv("/proc/self/exe", pointers.data());
  const int error = errno;
  kept.empty() ? ::unsetenv("OPENBLAS_CORETYPE") : ::setenv("OPENBLAS_CORETYPE", kept.c_str(), 1);
  return fmt::format("the program cannot start itself again: {}", std::strerror(error));
}

}  // namespace

void settle_blas_kernel(const std::string& request, const std::vector<std::string>& argv) {
  const BlasKernelFacts facts = blas_kernel_facts();
  BlasKernelChoice choice =
      choose_blas_kernel(request.empty() ? std::nullopt : std::optional(request), facts);
  if (choice.action == BlasKernelAction::restart) choice.reason = restart(argv);
  if (choice.action == BlasKernelAction::keep) return;
  if (!request.empty()) throw ConfigError(flag, request, "native (" + choice.reason + ")");
  say(fmt::format(
      "note: BLAS runs its kernel {}, not {}, so results may differ from those of other machines: {} "
      "({} native silences this note)\n",
      facts.running, fixed_blas_kernel, choice.reason, flag));
}

}  // namespace bb::cli
