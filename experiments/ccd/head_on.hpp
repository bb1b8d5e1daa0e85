// Head-on sweeps: a point straight through a triangle from a tiny gap, far from the origin. The hardest case for a time
// of impact, since the state that is accepted has to be written down in the same precision.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bb::ccd {

struct HeadOn {
  std::string precision;  // double or float
  double offset = 0;      // m from the origin
  double gap = 0;         // m, before the start is rounded
  int sweeps = 0;
  int start_wrong = 0;  // rounding alone put the start on the plane or beyond it; not swept
  int refused = 0;      // no motion allowed: the start is within 16 ulps of the triangle
  int capped = 0;       // stopped by the cap on probes
  int crossed = 0;      // the accepted state, rounded, is on the plane or beyond it, by exact signs
};

/// `sweeps` random triangles of size 1 m for each precision, offset (0, 10 and 1000 m) and gap (1e-5, 1e-6, 1e-7 and,
/// in double, 1e-12 and 1e-14 m): from the gap above an inner point to as far as 1 m below, ACCD with park 0; the state
/// x0 + toi (x1 - x0) is rounded as a solver commits it and judged by core/audit. Deterministic in seed.
std::vector<HeadOn> head_on_sweeps(int sweeps, std::uint64_t seed);

bool any_crossed(const std::vector<HeadOn>& rows);
std::string head_on_table(const std::vector<HeadOn>& rows);

}  // namespace bb::ccd
