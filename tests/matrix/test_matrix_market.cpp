// Matrix Market: what is written comes back bit for bit; every fault of a file is named with its line.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "core/math/error.hpp"
#include "experiments/matrix/matrix_market.hpp"

namespace bb::matrix_market_test {
namespace {

Eigen::SparseMatrix<double> lower(int n, const std::vector<Eigen::Triplet<double>>& entries) {
  Eigen::SparseMatrix<double> out(n, n);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

void expect_same_bits(const Eigen::SparseMatrix<double>& a, const Eigen::SparseMatrix<double>& b) {
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_EQ(a.nonZeros(), b.nonZeros());
  for (Eigen::Index j = 0; j <= a.cols(); ++j) ASSERT_EQ(a.outerIndexPtr()[j], b.outerIndexPtr()[j]);
  for (Eigen::Index k = 0; k < a.nonZeros(); ++k) {
    ASSERT_EQ(a.innerIndexPtr()[k], b.innerIndexPtr()[k]);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(a.valuePtr()[k]), std::bit_cast<std::uint64_t>(b.valuePtr()[k]));
  }
}

std::string complaint(const std::string& text) {
  try {
    parse_matrix_market(text, "a.mtx");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

std::string file(const char* first, const char* rest) {
  std::string text = first;
  return text.append(rest);
}

constexpr const char* head = "%%MatrixMarket matrix coordinate real symmetric\n";
constexpr const char* general = "%%MatrixMarket matrix coordinate real general\n";

TEST(MatrixMarket, EveryDoubleComesBackBitForBit) {
  std::mt19937_64 random(1);
  std::vector<Eigen::Triplet<double>> entries;
  constexpr int n = 200;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; j += 7) {
      double value = 0;
      do {
        value = std::bit_cast<double>(random());  // every exponent and sign
      } while (!std::isfinite(value));
      entries.emplace_back(i, j, value);
    }
  }
  entries.emplace_back(1, 1, 0.0);  // a stored zero stays an entry
  entries.emplace_back(2, 2, -0.0);
  entries.emplace_back(3, 3, std::numeric_limits<double>::denorm_min());
  entries.emplace_back(4, 4, std::numeric_limits<double>::max());
  const auto a = lower(n, entries);
  ASSERT_GT(a.nonZeros(), 2000);
  expect_same_bits(a, parse_matrix_market(matrix_market_text(a), "a.mtx"));
}

TEST(MatrixMarket, BothTrianglesMakeTheLowerOne) {
  const auto a =
      parse_matrix_market(file(general, "% a comment\n\n2 2 4\n1 1 2\n2 2 3\n1 2 -0.5\n2 1 -0.5\n"), "a.mtx");
  expect_same_bits(a, lower(2, {{0, 0, 2}, {1, 0, -0.5}, {1, 1, 3}}));
  const auto rounded =
      parse_matrix_market(file(general, "2 2 4\n1 1 2\n2 2 3\n1 2 1e-15\n2 1 3e-15\n"), "a.mtx");
  EXPECT_DOUBLE_EQ(rounded.coeff(1, 0), 2e-15);
}

TEST(MatrixMarket, UpperCaseIntegersAndWindowsLinesAreRead) {
  const auto a = parse_matrix_market(
      "%%matrixmarket MATRIX Coordinate Integer Symmetric\r\n1 1 1\r\n1 1 4\r\n", "a.mtx");
  EXPECT_EQ(a.coeff(0, 0), 4);
}

struct Fault {
  const char *name, *head, *body;
  std::vector<std::string> says;
};

TEST(MatrixMarket, EveryFaultIsNamedWithItsLine) {
  const std::vector<Fault> faults{
      {"empty", "", "", {"a.mtx:1", "an empty file"}},
      {"banner", "", "3 3 1\n", {"a.mtx:1", "\"3 3 1\"", "%%MatrixMarket matrix coordinate real symmetric"}},
      {"complex", "%%MatrixMarket matrix coordinate complex symmetric\n", "1 1 1\n", {"a.mtx:1", "complex"}},
      {"array", "%%MatrixMarket matrix array real general\n", "1 1\n1\n", {"a.mtx:1", "array"}},
      {"no_sizes", head, "% only this\n", {"no line of sizes", "rows, columns and entries"}},
      {"two_sizes", head, "1 1\n1 1 1\n", {"a.mtx:2", "\"1 1\""}},
      {"zero_rows", head, "0 0 0\n", {"a.mtx:2", "three integers > 0"}},
      {"not_square", head, "2 3 2\n1 1 1\n2 2 1\n", {"a.mtx:2", "2 x 3", "a square matrix"}},
      {"counts", head, "2 2 99\n1 1 1\n2 2 1\n", {"a.mtx:2", "99 entries", "at most"}},
      {"rows", head, "999999999 999999999 1\n1 1 1\n", {"a.mtx:2", "999999999 rows"}},
      {"truncated", head, "3 3 3\n1 1 1000000\n2 2 1\n", {"after 2 entries", "3 entries, as announced"}},
      {"too_many", head, "1 1 1\n1 1 1\n1 1 2\n", {"a.mtx:4", "entry 2", "1 entries"}},
      {"nan", head, "1 1 1\n1 1 nan\n", {"a.mtx:3", "nan", "a finite number"}},
      {"inf", head, "1 1 1\n1 1 -inf\n", {"a.mtx:3", "-inf", "a finite number"}},
      {"overflow", head, "1 1 1\n1 1 1e999\n", {"a.mtx:3", "1e999"}},
      {"no_number", head, "1 1 1\n1 1 x\n", {"a.mtx:3", "\"x\"", "a number"}},
      {"no_value", head, "2 2 1\n1 1\n 2 2\n", {"a.mtx:3", "\"1 1\"", "row, column and value"}},
      {"index_0", head, "1 1 1\n0 1 1\n", {"a.mtx:3", "row 0", "1 to 1"}},
      {"index_high", head, "1 1 1\n1 2 1\n", {"a.mtx:3", "column 2", "1 to 1"}},
      {"upper", head, "2 2 2\n1 1 1\n1 2 1\n", {"a.mtx:4", "(1, 2)", "row >= column"}},
      {"twice", head, "2 2 3\n1 1 1\n2 2 1\n1 1 5\n", {"a.mtx:5", "(1, 1) again, first in line 3"}},
      {"not_symmetric",
       general,
       "2 2 4\n1 1 1\n2 2 1\n1 2 0.5\n2 1 0.6\n",
       {"a.mtx:6", "(2, 1) = 0.6 where (1, 2) = 0.5", "a symmetric matrix"}},
      {"one_sided", general, "2 2 3\n1 1 1\n2 2 1\n1 2 0.5\n", {"a.mtx:5", "(1, 2) = 0.5", "= 0"}},
  };
  for (const Fault& fault : faults) {
    const std::string what = complaint(file(fault.head, fault.body));
    EXPECT_FALSE(what.empty()) << fault.name << " was accepted";
    for (const std::string& word : fault.says) {
      EXPECT_NE(what.find(word), std::string::npos) << fault.name << ": " << what;
    }
  }
}

TEST(MatrixMarket, NoPrefixOfAFileIsReadAsAnotherMatrixOfItsCount) {
  const std::string text = matrix_market_text(lower(2, {{0, 0, 2.25}, {1, 0, -0.5}, {1, 1, 3.125}}));
  int refused = 0;
  for (std::size_t length = 0; length + 1 < text.size(); ++length) {
    const std::string part = text.substr(0, length);
    const bool last_number_begun = part.find("2 2 3\n") != std::string::npos &&
                                   part.rfind("2 2 ") + 4 < length &&
                                   part.rfind("2 2 ") > part.find("2 2 3\n");
    if (last_number_begun) continue;  // only the hash in the side-car shows it
    EXPECT_FALSE(complaint(part).empty()) << length << ": " << part;
    ++refused;
  }
  EXPECT_GT(refused, 40);
}

}  // namespace
}  // namespace bb::matrix_market_test
