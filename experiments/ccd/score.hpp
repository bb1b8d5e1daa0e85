// How the two continuous tests of this program answer queries with a known truth.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "experiments/ccd/query.hpp"

namespace bb::ccd {

/// One line of the table: a kind of pair, a precision and a method.
struct Score {
  std::string pair;       // point_triangle or edge_edge
  std::string precision;  // of coordinates and arithmetic: double or float
  std::string method;     // accd, or audit: the certificate of the motions that a run accepted
  std::size_t queries = 0, positives = 0;
  std::size_t left_out =
      0;  // audit only: coordinates were rounded, so that the truth is that of another motion
  std::size_t false_negatives = 0;  // they meet, and the answer proves that they do not
  std::size_t false_positives = 0;  // they do not, and the answer is a hit (audit: a proof of one)
  std::size_t capped = 0;           // accd: by its probes; audit: neither proof was found
  double ns_a_query = 0;            // mean wall time of one pass over all; a report, no measurement
};

/// Both kinds: ACCD in double and float, park 0, and the audit in double; kinds without queries have no line.
/// Where a coordinate was rounded, ACCD gets an offset of 2 ulps (eps times) of the query's largest coordinate: rounding
/// moves each of the two touching points by at most sqrt(3)/2 of them, so that a pair that meets is still one that must
/// be stopped. The audit has no offset and judges what was not rounded.
std::vector<Score> score_queries(const QuerySet& queries);

bool any_false_negative(const std::vector<Score>& scores);
std::string score_table(const std::vector<Score>& scores);

}  // namespace bb::ccd
