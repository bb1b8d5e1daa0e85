// The side-car of a matrix of seven rows: what is accepted is written and read again as the same.
#include "experiments/matrix/side_car.hpp"
#include "core/base/record/provenance.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/matrix/stored.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bb::StoredSystem system = bb::chain(7, 2.5);
  return bb::fuzz::refused_or_read([&] {
    bb::StoredSystem read = system;
    bb::parse_side_car(bb::fuzz::text_of(data, size), "fuzz.json", std::string(64, 'a'), read);
    const auto n = static_cast<int>(read.system.lower.rows());
    bb::fuzz::require(read.rhs.size() == n && read.rhs.allFinite(), "a right-hand side that does not fit");
    bb::fuzz::require(read.system.block_start.front() == 0 && read.system.block_start.back() == n,
                      "blocks that do not cover the rows");
    bb::StoredSystem again = system;
    const std::string written = bb::side_car_text(read, "fuzz.mtx", "");
    bb::parse_side_car(written, "again.json", bb::sha256_hex(""), again);
    bb::fuzz::require(bb::side_car_text(again, "fuzz.mtx", "") == written,
                      "a side-car does not read back as itself");
  });
}
