#include "experiments/ccd/read_queries.hpp"

#include <fmt/format.h>
#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/base/input/read_file.hpp"
#include "core/base/input/text_scanner.hpp"
#include "core/math/error.hpp"

namespace bb::ccd {
namespace {

namespace fs = std::filesystem;

constexpr InputKind query_table{"a file of CCD queries (.csv)", std::uint64_t{256} << 20};
constexpr std::size_t rows_a_query = 8, most_digits = 2000;
constexpr double most_coordinate = 1e15;  // m, as of meshes; squares stay within float

/// The fields of a row between commas.
std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> out;
  for (;;) {
    const std::size_t comma = line.find(',');
    out.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return out;
    line.remove_prefix(comma + 1);
  }
}

mpz_class integer(const TextScanner& at, std::string_view word) {
  const std::string_view digits = word.starts_with('-') ? word.substr(1) : word;
  const bool good = !digits.empty() && digits.size() <= most_digits &&
                    std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!good) at.fail(fmt::format("\"{}\"", word.substr(0, 40)), "an integer in decimal digits");
  return mpz_class(std::string(word), 10);  // by default a leading zero means octal
}

/// The nearest double, ties to even, of a value within most_coordinate; mpq_class::get_d truncates.
double nearest(const mpq_class& value) {
  const double inward = value.get_d();
  if (mpq_class(inward) == value) return inward;
  const double outward = std::nextafter(inward, value > 0 ? HUGE_VAL : -HUGE_VAL);
  const mpq_class below = abs(value - mpq_class(inward)), above = abs(mpq_class(outward) - value);
  if (below != above) return below < above ? inward : outward;
  int exponent = 0;
  const double mantissa = std::frexp(inward, &exponent);
  return std::fmod(std::ldexp(mantissa, 53), 2) == 0 ? inward : outward;
}

double coordinate(const TextScanner& at, std::string_view top, std::string_view bottom, Query& query) {
  const mpz_class denominator = integer(at, bottom);
  if (denominator == 0) at.fail("a denominator of 0", "another integer");
  mpq_class value(integer(at, top), denominator);
  value.canonicalize();
  if (abs(value) > most_coordinate) {
    at.fail("a coordinate that is too large", fmt::format("from -{0:g} to {0:g} m", most_coordinate));
  }
  const double out = nearest(value);
  query.rounded_double = query.rounded_double || mpq_class(out) != value;
  query.rounded_float =
      query.rounded_float || mpq_class(static_cast<double>(static_cast<float>(out))) != value;
  return out;
}

bool truth(const TextScanner& at, std::string_view word) {
  if (word != "0" && word != "1") at.fail(fmt::format("the truth \"{}\"", word.substr(0, 40)), "0 or 1");
  return word == "1";
}

/// Entries of a folder by name; none when it is no folder.
/// None where there is no such folder. Errors: ConfigError for one that cannot be read.
std::vector<fs::path> sorted_entries(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code error;
  if (!fs::exists(folder, error)) return out;
  for (const auto& entry : fs::directory_iterator(folder, error)) out.push_back(entry.path());
  if (error && fs::is_directory(folder))
    throw ConfigError(folder.string(), error.message(), "a folder that can be read");
  std::sort(out.begin(), out.end());
  return out;
}

void append_files(const fs::path& folder, std::vector<Query>& out) {
  for (const fs::path& file : sorted_entries(folder)) {
    if (file.extension() != ".csv") continue;
    const std::vector<Query> queries =
        parse_queries(read_input_file(file.string(), query_table), file.string());
    out.insert(out.end(), queries.begin(), queries.end());
  }
}

}  // namespace

std::vector<Query> parse_queries(const std::string& text, const std::string& name) {
  std::vector<Query> out;
  TextScanner at(text, name);
  std::size_t row = 0;
  for (; at.next_line(); ++row) {
    const auto fields = fields_of(at.words().size() == 1 ? at.word(0) : std::string_view());
    if (fields.size() != 7)
      at.fail(fmt::format("{} fields", fields.size()), "7: three fractions and the truth");
    if (row % rows_a_query == 0) out.emplace_back();
    Query& query = out.back();
    const std::size_t in_query = row % rows_a_query;
    const auto vertex = static_cast<Eigen::Index>(in_query % 4);
    for (std::size_t k = 0; k < 3; ++k) {
      (in_query < 4 ? query.x0 : query.x1)(static_cast<Eigen::Index>(k), vertex) =
          coordinate(at, fields[2 * k], fields[2 * k + 1], query);
    }
    const bool hits = truth(at, fields[6]);
    if (in_query == 0) query.hits = hits;
    if (hits != query.hits)
      at.fail("another truth than in the query's first row", "the same in all eight rows");
  }
  if (row % rows_a_query != 0 || row == 0) {
    throw ConfigError(name, fmt::format("{} rows", row), "eight rows a query, and at least one query");
  }
  return out;
}

QuerySet read_queries(const std::string& folder) {
  if (!fs::is_directory(folder)) throw ConfigError(folder, "no folder", "a folder of CCD queries");
  QuerySet out;
  for (const fs::path& scene : sorted_entries(folder)) {
    append_files(scene / "vertex-face", out.point_triangle);
    append_files(scene / "edge-edge", out.edge_edge);
  }
  if (out.point_triangle.empty() && out.edge_edge.empty()) {
    throw ConfigError(folder, "no query", "SCENE/vertex-face/*.csv or SCENE/edge-edge/*.csv");
  }
  return out;
}

}  // namespace bb::ccd
