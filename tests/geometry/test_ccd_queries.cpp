// ACCD against the hand-made queries of Wang et al. 2021 (exact rational coordinates with ground truth): a
// false negative is a tunnelled pair and forbidden; false positives (stopped below the ulp floor) are
// counted and shown.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "core/geometry/accd.hpp"
#include "tests/optional_data.hpp"

namespace {

using bb::Mat;
using bb::PairKind;

struct Query {
  Mat<double, 3, 4> x0, x1;
  bool truth = false;
};

/// One file: 8 rows a query, columns numerator and denominator of x, y, z, then the truth.
std::vector<Query> read_queries(const std::filesystem::path& file, int& n_inexact) {
  std::ifstream in(file);
  std::vector<Query> queries;
  std::string line, field;
  for (int row = 0; std::getline(in, line); ++row) {
    if (row % 8 == 0) queries.emplace_back();
    Query& query = queries.back();
    std::istringstream fields(line);
    for (int k = 0; k < 3; ++k) {
      std::string numerator, denominator;
      std::getline(fields, numerator, ',');
      std::getline(fields, denominator, ',');
      mpq_class value(numerator + "/" + denominator);
      value.canonicalize();
      (row % 8 < 4 ? query.x0 : query.x1)(k, row % 4) = value.get_d();
      n_inexact += mpq_class(value.get_d()) == value ? 0 : 1;
    }
    std::getline(fields, field, ',');
    query.truth = std::stoi(field) == 1;
  }
  return queries;
}

struct Counts {
  int queries = 0, positives = 0, false_negatives = 0, false_positives = 0, capped = 0, most_probes = 0;
  long probes = 0;
};

template <PairKind K>
void run(const std::vector<Query>& queries, Counts& counts) {
  for (const Query& query : queries) {
    const auto result = bb::accd<K, double>(query.x0, query.x1, 0.0, 0.0);
    ++counts.queries;
    counts.positives += query.truth;
    counts.false_negatives += query.truth && !result.hit;
    counts.false_positives += !query.truth && result.hit;
    counts.capped += result.capped;
    counts.probes += result.probes;
    counts.most_probes = std::max(counts.most_probes, result.probes);

    // Float sees the rounded coordinates; what it proves free, double must prove free.
    const Mat<float, 3, 4> f0 = query.x0.cast<float>(), f1 = query.x1.cast<float>();
    const auto in_float = bb::accd<K, float>(f0, f1, 0.0f, 0.0f);
    const auto in_double = bb::accd<K, double>(f0.cast<double>(), f1.cast<double>(), 0.0, 0.0);
    EXPECT_TRUE(in_float.hit || !in_double.hit);
    EXPECT_LE(in_float.toi, in_double.toi * (1 + 1e-5));
  }
}

template <PairKind K>
void run_all(const std::string& folder) {
  const std::filesystem::path data = optional_data("ccd-queries");
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "no folder " << data;

  Counts counts;
  int n_inexact = 0;
  for (const auto& scene : std::filesystem::directory_iterator(data)) {
    if (!std::filesystem::is_directory(scene.path() / folder)) continue;
    for (const auto& file : std::filesystem::directory_iterator(scene.path() / folder)) {
      run<K>(read_queries(file.path(), n_inexact), counts);
    }
  }

  std::cout << bb::pair_name(K) << ": " << counts.queries << " queries, " << counts.positives << " positive, "
            << counts.false_negatives << " false negatives, " << counts.false_positives
            << " false positives, " << counts.capped << " capped, " << counts.probes << " probes, at most "
            << counts.most_probes << "; coordinates rounded: " << n_inexact << "\n";
  testing::Test::RecordProperty("queries", counts.queries);
  testing::Test::RecordProperty("false_positives", counts.false_positives);
  testing::Test::RecordProperty("capped", counts.capped);
  EXPECT_GT(counts.positives, 0);
  EXPECT_GT(counts.queries, counts.positives);
  EXPECT_EQ(counts.false_negatives, 0);
}

TEST(CcdQueries, NoFalseNegativeOnVertexFace) { run_all<PairKind::point_triangle>("vertex-face"); }
TEST(CcdQueries, NoFalseNegativeOnEdgeEdge) { run_all<PairKind::edge_edge>("edge-edge"); }

}  // namespace
