// A line of trace.jsonl: what is read is written and read again as the same.
#include "core/base/record/parse_record.hpp"
#include "core/base/record/writer.hpp"
#include "tests/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return bb::fuzz::refused_or_read([&] {
    const std::string written = bb::to_json(bb::parse_trace_row(bb::fuzz::text_of(data, size), "fuzz.jsonl"));
    bb::fuzz::require(bb::to_json(bb::parse_trace_row(written, "again.jsonl")) == written,
                      "a line of the trace does not read back as itself");
  });
}
