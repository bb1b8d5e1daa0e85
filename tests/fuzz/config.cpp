// A config: what is accepted is written out in full and read again as the same. No file is named, so none is opened
// but the presets of formulations.
#include "experiments/config/parse.hpp"
#include "tests/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = bb::fuzz::text_of(data, size);
  if (text.find("extends") != std::string::npos) return 0;  // would open another file
  return bb::fuzz::refused_or_read([&] {
    const std::string resolved = bb::resolved_json(bb::parse_config(text, "fuzz.json"));
    bb::fuzz::require(bb::resolved_json(bb::parse_config(resolved, "again.json")) == resolved,
                      "a resolved config does not read back as itself");
  });
}
