#include "experiments/matrix/matrix_market.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "core/base/input/text_scanner.hpp"

namespace bb {
namespace {

constexpr const char* banner = "%%MatrixMarket matrix coordinate real symmetric";

struct Entry {
  int row, column;  // from 0
  double value;
  long long line;
};

bool before(const Entry& a, const Entry& b) {
  return a.column != b.column ? a.column < b.column : a.row < b.row;
}

std::string lower_case(std::string_view word) {
  std::string out(word);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string shown(const std::vector<std::string_view>& words) {
  std::string line = fmt::format("{}", fmt::join(words, " "));
  if (line.size() > 60) line = line.substr(0, 60) + "...";
  return '"' + line + '"';
}

class Parser {
 public:
  Parser(const std::string& text, const std::string& name) : text_(text), name_(name), scan_(text, name) {}

  Eigen::SparseMatrix<double> parse() {
    read_banner();
    read_sizes();
    read_entries();
    std::sort(entries_.begin(), entries_.end(), before);
    refuse_repetitions();
    if (!symmetric_) fold();
    Eigen::SparseMatrix<double> lower(n_, n_);
    std::vector<Eigen::Triplet<double>> triplets;
    triplets.reserve(entries_.size());
    for (const Entry& e : entries_) triplets.emplace_back(e.row, e.column, e.value);
    lower.setFromTriplets(triplets.begin(), triplets.end());
    return lower;
  }

 private:
  void read_banner() {
    const std::string allowed = fmt::format("\"{}\" (or general) as the first line", banner);
    if (!scan_.next_line()) throw ConfigError(name_ + ":1", "an empty file", allowed);
    std::vector<std::string> words;
    for (const std::string_view word : scan_.words()) words.push_back(lower_case(word));
    const bool good = words.size() == 5 && words[0] == "%%matrixmarket" && words[1] == "matrix" &&
                      words[2] == "coordinate" && (words[3] == "real" || words[3] == "integer") &&
                      (words[4] == "symmetric" || words[4] == "general");
    if (!good) scan_.fail(shown(scan_.words()), allowed);
    symmetric_ = words[4] == "symmetric";
  }

  /// The next line with something in it that is no comment.
  bool next() {
    while (scan_.next_line()) {
      if (!scan_.words().empty() && !scan_.word(0).starts_with('%')) return true;
    }
    return false;
  }

  void read_sizes() {
    const char* allowed = "rows, columns and entries, three integers > 0";
    if (!next()) throw ConfigError(name_, "no line of sizes", allowed);
    if (scan_.words().size() != 3) scan_.fail(shown(scan_.words()), allowed);
    const long long rows = scan_.integer(0), columns = scan_.integer(1);
    count_ = scan_.integer(2);
    if (rows < 1 || columns < 1 || count_ < 1) scan_.fail(shown(scan_.words()), allowed);
    if (rows != columns) scan_.fail(fmt::format("{} x {}", rows, columns), "a square matrix");
    // "1 1 1\n" has six bytes, and a row without entries makes no system worth its memory
    const auto most = static_cast<long long>((text_.size() - scan_.position() + 1) / 6);
    if (count_ > most) {
      scan_.fail(fmt::format("{} entries", count_),
                 fmt::format("at most the {} that the file goes on for", most));
    }
    if (rows > 16 * count_) scan_.fail(fmt::format("{} rows", rows), "at most 16 rows an entry");
    if (rows > std::numeric_limits<int>::max()) scan_.fail(fmt::format("{} rows", rows), "at most 2^31 - 1");
    n_ = static_cast<int>(rows);
  }

  int index(std::size_t word, const char* what) const {
    const long long i = scan_.integer(word);
    if (i < 1 || i > n_) scan_.fail(fmt::format("{} {}", what, i), fmt::format("1 to {}", n_));
    return static_cast<int>(i - 1);
  }

  void read_entries() {
    entries_.reserve(static_cast<std::size_t>(count_));
    while (next()) {
      if (static_cast<long long>(entries_.size()) == count_) {
        scan_.fail(fmt::format("entry {}", count_ + 1), fmt::format("{} entries, as announced", count_));
      }
      if (scan_.words().size() != 3) scan_.fail(shown(scan_.words()), "row, column and value of an entry");
      const Entry e{index(0, "row"), index(1, "column"), scan_.number(2), scan_.line()};
      if (!std::isfinite(e.value)) scan_.fail(std::string(scan_.word(2)), "a finite number");
      if (symmetric_ && e.row < e.column) {
        scan_.fail(fmt::format("entry ({}, {})", e.row + 1, e.column + 1),
                   "the lower triangle (row >= column) in a symmetric file");
      }
      entries_.push_back(e);
    }
    if (static_cast<long long>(entries_.size()) < count_) {
      scan_.fail(fmt::format("the end after {} entries", entries_.size()),
                 fmt::format("{} entries, as announced", count_));
    }
  }

  void refuse_repetitions() const {
    const auto twice = std::adjacent_find(entries_.begin(), entries_.end(),
                                          [](const Entry& a, const Entry& b) { return !before(a, b); });
    if (twice == entries_.end()) return;
    const long long first = std::min(twice->line, (twice + 1)->line);
    const long long second = std::max(twice->line, (twice + 1)->line);
    throw ConfigError(
        fmt::format("{}:{}", name_, second),
        fmt::format("entry ({}, {}) again, first in line {}", twice->row + 1, twice->column + 1, first),
        "every entry once");
  }

  /// Both triangles to the lower one; entries_ is sorted before and after.
  void fold() {
    double largest = 0;
    for (const Entry& e : entries_) largest = std::max(largest, std::abs(e.value));
    std::vector<Entry> lower;
    for (const Entry& e : entries_) {
      const Entry mirror{e.column, e.row, 0, 0};
      const auto other = std::lower_bound(entries_.begin(), entries_.end(), mirror, before);
      const bool found = other != entries_.end() && !before(mirror, *other);
      const double value = found ? other->value : 0;
      if (std::abs(e.value - value) > symmetry_tolerance * largest) {
        throw ConfigError(
            fmt::format("{}:{}", name_, e.line),
            fmt::format("({0}, {1}) = {2} where ({1}, {0}) = {3}", e.row + 1, e.column + 1, e.value, value),
            fmt::format("a symmetric matrix, to {:g} of the largest entry", symmetry_tolerance));
      }
      if (e.row >= e.column) {
        lower.push_back({e.row, e.column, e.value == value ? e.value : (e.value + value) / 2, e.line});
      } else if (!found) {
        lower.push_back({e.column, e.row, e.value / 2, e.line});
      }
    }
    std::sort(lower.begin(), lower.end(), before);
    entries_ = std::move(lower);
  }

  const std::string &text_, &name_;
  TextScanner scan_;
  bool symmetric_ = true;
  int n_ = 0;
  long long count_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace

std::string matrix_market_text(const Eigen::SparseMatrix<double>& lower) {
  std::string text = fmt::format("{}\n{} {} {}\n", banner, lower.rows(), lower.cols(), lower.nonZeros());
  for (Eigen::Index column = 0; column < lower.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(lower, column); it; ++it) {
      fmt::format_to(std::back_inserter(text), "{} {} {}\n", it.row() + 1, it.col() + 1, it.value());
    }
  }
  return text;
}

Eigen::SparseMatrix<double> parse_matrix_market(const std::string& text, const std::string& name) {
  return Parser(text, name).parse();
}

}  // namespace bb
