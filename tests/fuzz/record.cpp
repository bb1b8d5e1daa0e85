// A record (run.json): what is read is written and read again as the same.
#include "core/base/record/parse_record.hpp"
#include "core/base/record/writer.hpp"
#include "tests/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return bb::fuzz::refused_or_read([&] {
    const auto record = bb::parse_run(bb::fuzz::text_of(data, size), "fuzz.json");
    if (!record) return;
    const std::string written = bb::to_json(*record);
    const auto again = bb::parse_run(written, "again.json");
    bb::fuzz::require(again && bb::to_json(*again) == written, "a record does not read back as itself");
  });
}
