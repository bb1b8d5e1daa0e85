// A sweep file up to its list of cases; the configs of the cases are the target `config`.
#include "experiments/cli/sweep_cases.hpp"
#include "tests/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return bb::fuzz::refused_or_read([&] {
    const bb::SweepSpec spec = bb::parse_sweep(bb::fuzz::text_of(data, size), "fuzz.json");
    bb::fuzz::require(!spec.cases.empty() && spec.cases.size() <= bb::max_sweep_cases,
                      "cases beyond their bound");
    for (const bb::SweepCase& one : spec.cases) {
      bb::fuzz::require(!one.reference || *one.reference < spec.cases.size(), "a reference that is no case");
    }
  });
}
