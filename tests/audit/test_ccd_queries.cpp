// The hand-made CCD queries of Wang et al. 2021 with exact rational coordinates and ground truth. Required:
// no query that truly hits is certified free.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "core/audit/pair_verdict.hpp"
#include "tests/optional_data.hpp"

namespace bb::audit::ccd_queries_test {
namespace {

namespace fs = std::filesystem;

fs::path data_folder() { return optional_data("ccd-queries"); }

struct Query {
  std::array<Vec3d, 4> x0, x1;
  bool hits = false;
  bool exact = true;  // every coordinate is a double
};

/// One row: numerator, denominator of x, y, z, then the truth.
Vec3d read_row(const std::string& line, Query& query) {
  std::istringstream in(line);
  std::string top, bottom;
  Vec3d point;
  for (int k = 0; k < 3; ++k) {
    std::getline(in, top, ',');
    std::getline(in, bottom, ',');
    mpq_class value{mpz_class(top), mpz_class(bottom)};
    value.canonicalize();
    point[k] = value.get_d();
    query.exact = query.exact && mpq_class(point[k]) == value;
  }
  std::getline(in, top);
  query.hits = top[0] == '1';
  return point;
}

std::vector<Query> read_queries(const fs::path& file) {
  std::ifstream in(file);
  std::vector<Query> out;
  std::string line;
  for (std::size_t row = 0; std::getline(in, line); ++row) {
    if (row % 8 == 0) out.emplace_back();
    Query& q = out.back();
    (row % 8 < 4 ? q.x0 : q.x1)[row % 4] = read_row(line, q);
  }
  return out;
}

struct Score {
  int exact = 0, rounded = 0, hits = 0, false_negatives = 0, false_positives = 0, free_unproven = 0,
      hit_unproven = 0;
};

template <class Pair>
void judge_files(const std::string& kind, Score& score) {
  for (const auto& scene : fs::directory_iterator(data_folder())) {
    if (!scene.is_directory() || !fs::is_directory(scene.path() / kind)) continue;
    for (const auto& file : fs::directory_iterator(scene.path() / kind)) {
      for (const Query& q : read_queries(file.path())) {
        if (!q.exact) {
          ++score.rounded;
          continue;
        }
        const Verdict verdict = judge<Pair>({q.x0, q.x1}, 1e-9);
        ++score.exact;
        score.hits += q.hits;
        score.false_negatives += q.hits && verdict == Verdict::certified;
        score.hit_unproven += q.hits && verdict == Verdict::unproven;
        score.false_positives += !q.hits && verdict == Verdict::violation;
        score.free_unproven += !q.hits && verdict == Verdict::unproven;
      }
    }
  }
}

void report(const char* kind, const Score& s) {
  std::printf(
      "%s: %d exact queries (%d left out), %d hits; false negatives %d, false positives %d, unproven %d of "
      "the hits and %d of the free\n",
      kind, s.exact, s.rounded, s.hits, s.false_negatives, s.false_positives, s.hit_unproven,
      s.free_unproven);
}

void expect_sound(const Score& s, int least_queries, int least_hits) {
  EXPECT_GE(s.exact, least_queries);
  EXPECT_GE(s.hits, least_hits);
  EXPECT_EQ(s.false_negatives, 0);
  EXPECT_EQ(s.false_positives, 0);  // a violation is a proof
}

TEST(CcdQueries, vertex_face) {
  if (!fs::is_directory(data_folder())) GTEST_SKIP() << "no CCD queries at " << data_folder();
  Score score;
  judge_files<VertexTriangle>("vertex-face", score);
  report("vertex-face", score);
  expect_sound(score, 1500, 50);
}

TEST(CcdQueries, edge_edge) {
  if (!fs::is_directory(data_folder())) GTEST_SKIP() << "no CCD queries at " << data_folder();
  Score score;
  judge_files<EdgeEdge>("edge-edge", score);
  report("edge-edge", score);
  expect_sound(score, 2500, 50);
}

}  // namespace
}  // namespace bb::audit::ccd_queries_test
