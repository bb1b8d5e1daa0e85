#include "experiments/ccd/score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <type_traits>

#include "core/audit/pair_verdict.hpp"
#include "core/geometry/accd.hpp"

namespace bb::ccd {
namespace {

constexpr double audit_tolerance =
    1e-9;  // m, below which exact signs are tried early; no answer depends on it

class Clock {
 public:
  double ns_each(std::size_t n) const {
    const std::chrono::duration<double, std::nano> passed = std::chrono::steady_clock::now() - start_;
    return n == 0 ? 0 : passed.count() / static_cast<double>(n);
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

template <class T>
T offset_of(const Query& query) {
  if (!(std::is_same_v<T, float> ? query.rounded_float : query.rounded_double)) return T(0);
  const double largest = std::max(query.x0.cwiseAbs().maxCoeff(), query.x1.cwiseAbs().maxCoeff());
  return 2 * std::numeric_limits<T>::epsilon() * static_cast<T>(largest);
}

template <PairKind K, class T>
Score score_accd(const std::vector<Query>& queries) {
  Score out{pair_name(K), std::is_same_v<T, float> ? "float" : "double", "accd"};
  const Clock clock;
  for (const Query& q : queries) {
    const auto result = accd<K, T>(q.x0.cast<T>(), q.x1.cast<T>(), offset_of<T>(q), T(0));
    ++out.queries;
    out.positives += q.hits;
    out.false_negatives += q.hits && !result.hit;
    out.false_positives += !q.hits && result.hit;
    out.capped += result.capped;
  }
  out.ns_a_query = clock.ns_each(out.queries);
  return out;
}

template <class Pair, PairKind K>
Score score_audit(const std::vector<Query>& queries) {
  Score out{pair_name(K), "double", "audit"};
  const Clock clock;
  for (const Query& q : queries) {
    if (q.rounded_double) {
      ++out.left_out;
      continue;
    }
    audit::PairMotion<Pair> motion;
    for (std::size_t i = 0; i < 4; ++i) {
      motion.x0[i] = q.x0.col(static_cast<Eigen::Index>(i));
      motion.x1[i] = q.x1.col(static_cast<Eigen::Index>(i));
    }
    const audit::Verdict verdict = audit::judge<Pair>(motion, audit_tolerance);
    ++out.queries;
    out.positives += q.hits;
    out.false_negatives += q.hits && verdict == audit::Verdict::certified;
    out.false_positives += !q.hits && verdict == audit::Verdict::violation;
    out.capped += verdict == audit::Verdict::unproven;
  }
  out.ns_a_query = clock.ns_each(out.queries);
  return out;
}

template <PairKind K, class Pair>
void score_kind(const std::vector<Query>& queries, std::vector<Score>& out) {
  if (queries.empty()) return;
  out.push_back(score_accd<K, double>(queries));
  out.push_back(score_accd<K, float>(queries));
  out.push_back(score_audit<Pair, K>(queries));
}

}  // namespace

std::vector<Score> score_queries(const QuerySet& queries) {
  std::vector<Score> out;
  score_kind<PairKind::point_triangle, audit::VertexTriangle>(queries.point_triangle, out);
  score_kind<PairKind::edge_edge, audit::EdgeEdge>(queries.edge_edge, out);
  return out;
}

bool any_false_negative(const std::vector<Score>& scores) {
  return std::any_of(scores.begin(), scores.end(), [](const Score& s) { return s.false_negatives > 0; });
}

std::string score_table(const std::vector<Score>& scores) {
  std::string out = fmt::format("{:<15} {:<9} {:<6} {:>8} {:>9} {:>8} {:>9} {:>9} {:>8} {:>9}\n", "pair",
                                "precision", "method", "queries", "positives", "left out", "false neg",
                                "false pos", "capped", "ns/query");
  for (const Score& s : scores) {
    out += fmt::format("{:<15} {:<9} {:<6} {:>8} {:>9} {:>8} {:>9} {:>9} {:>8} {:>9.0f}\n", s.pair,
                       s.precision, s.method, s.queries, s.positives, s.left_out, s.false_negatives,
                       s.false_positives, s.capped, s.ns_a_query);
  }
  return out;
}

}  // namespace bb::ccd
