// A file of CCD queries: whole queries, finite coordinates.
#include "experiments/ccd/read_queries.hpp"
#include "tests/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return bb::fuzz::refused_or_read([&] {
    const auto queries = bb::ccd::parse_queries(bb::fuzz::text_of(data, size), "fuzz.csv");
    bb::fuzz::require(!queries.empty(), "a file without queries");
    for (const bb::ccd::Query& q : queries) {
      bb::fuzz::require(q.x0.allFinite() && q.x1.allFinite(), "a coordinate that is not finite");
    }
  });
}
