// A Matrix Market file: what is accepted is written and read again as the same lower triangle.
#include "experiments/matrix/matrix_market.hpp"
#include "tests/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return bb::fuzz::refused_or_read([&] {
    const auto lower = bb::parse_matrix_market(bb::fuzz::text_of(data, size), "fuzz.mtx");
    bb::fuzz::require(lower.rows() == lower.cols() && lower.rows() > 0, "no square matrix");
    if (lower.nonZeros() == 0) return;  // both triangles were given and cancelled: nothing to write
    const std::string written = bb::matrix_market_text(lower);
    bb::fuzz::require(bb::matrix_market_text(bb::parse_matrix_market(written, "again.mtx")) == written,
                      "a matrix does not read back as itself");
  });
}
