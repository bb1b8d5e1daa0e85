// The Google Benchmark suite. All subjects of registry.inc; seeds are fixed, so two runs have
// the same questions.
#include <oneapi/tbb/info.h>

#include "core/base/record/build_info.hpp"
#include "core/linear/blas_info.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

int main(int argc, char** argv) {
#define ENTRY(name, doc) bb::bench::register_##name();
#include "experiments/microbenchmarks/registry.inc"
#undef ENTRY
  benchmark::AddCustomContext("git_commit", std::string(bb::kBuildInfo.git_commit) +
                                                (bb::kBuildInfo.git_dirty ? " with changes" : ""));
  benchmark::AddCustomContext("compiler", bb::kBuildInfo.compiler);
  benchmark::AddCustomContext("flags", bb::kBuildInfo.flags);
  benchmark::AddCustomContext("blas", bb::blas_info().config);
  benchmark::AddCustomContext("threads", std::to_string(tbb::info::default_concurrency()));
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const std::size_t n_matching = benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return n_matching > 0 ? 0 : 2;
}
