// Depth-first bisection of time, earliest span first, with a cap on the number of spans.
#include "core/audit/pair_verdict.hpp"

#include <algorithm>
#include <optional>

#include "core/audit/exact_polygon.hpp"

namespace bb::audit {
namespace {

// A pair in lasting contact would be split for ever. Most pairs need some tens of spans, one that turns by a right angle at a
// gap of 1e-4 of its size about 8000; the cap costs 2.4 ms.
constexpr int max_pair_spans = 20000;
// The same for spans tried by integers, which cost some tens of microseconds each.
constexpr int max_exact_spans = 2000;
// A pair may be in contact all the time, which integers can decide. They are used when a pair has cost this many spans, and
// again whenever the cost has doubled, so that their cost stays a small part of it. A span by integers counts as several.
constexpr int first_look = 64, spans_per_exact_span = 16;
// A span in which nothing moves by more than this part of the pair's size is left to the integers: the
// allowance of the floating certificate is a few 2^-50 of it.
constexpr double rounding = 0x1p-50;

/// Half a length more on either side, so that a hit exactly at a split is inside a span.
TimeSpan widened(const TimeSpan& s) {
  const std::int64_t half = std::max<std::int64_t>((s.end - s.begin) / 2, 1);
  return {std::max<std::int64_t>(s.begin - half, 0), std::min(s.end + half, TimeSpan::one)};
}

template <class Pair>
class Bisection {
 public:
  Bisection(const PairMotion<Pair>& motion, const MovingPolygon<Pair>& polygon, double tolerance)
      : motion_(motion), polygon_(polygon), speed_(polygon.motion()), tolerance_(tolerance) {}

  Verdict run(Effort& effort) {
    TimeSpan stack[64];
    int top = 0;
    stack[top++] = TimeSpan{};
    bool doubt = false;
    auto& [spans, exact_spans] = effort;
    for (; top > 0; ++spans) {
      if (spans >= max_pair_spans || exact_spans >= max_exact_spans) return Verdict::unproven;
      const TimeSpan span = stack[--top];
      if (polygon_.any_separates(span)) continue;
      if (touches_for_long(spans + spans_per_exact_span * exact_spans, span)) return Verdict::unproven;
      const double moved = speed_ * span.length();
      const bool last = span.end - span.begin == 1 || moved <= rounding * polygon_.size();
      const bool always_exact = last || moved <= tolerance_;
      if (passes(span, always_exact)) return Verdict::violation;
      exact_spans += always_exact;
      if (always_exact && exact().any_separates(span)) continue;
      if (last) {
        doubt = true;
      } else {
        stack[top++] = {span.middle(), span.end};
        stack[top++] = {span.begin, span.middle()};
      }
    }
    return doubt ? Verdict::unproven : Verdict::certified;
  }

 private:
  const ExactPolygon<Pair>& exact() {
    if (!exact_) exact_.emplace(motion_);
    return *exact_;
  }
  /// Of a pair that stays in one plane no passage can be proven, so a time at which it meets settles the verdict.
  bool touches_for_long(int cost, const TimeSpan& span) {
    if (cost < next_look_) return false;
    next_look_ = 2 * cost;
    if (!in_plane_) in_plane_ = exact().stays_in_plane();
    return *in_plane_ && exact().meets_at(span.middle());
  }
  /// The span itself is tried too: widening may reach a turn of the pair.
  bool passes(const TimeSpan& span, bool always_exact) {
    if (in_plane_.value_or(false)) return false;
    const auto normal = polygon_.normal(span.middle());
    for (const TimeSpan& s : {span, widened(span)}) {
      if ((always_exact || polygon_.seems_to_pass(normal, s)) && exact().proves_passage(normal, s))
        return true;
    }
    return false;
  }

  const PairMotion<Pair>& motion_;
  const MovingPolygon<Pair>& polygon_;
  double speed_, tolerance_;
  std::optional<ExactPolygon<Pair>> exact_;
  std::optional<bool> in_plane_;
  int next_look_ = first_look;
};

}  // namespace

template <class Pair>
Verdict judge(const PairMotion<Pair>& motion, double tolerance, Effort* effort) {
  Effort own;
  Effort& spent = effort ? *effort : own;
  spent = {};
  const MovingPolygon<Pair> polygon(motion);
  if (polygon.axis_separates({}) || polygon.any_separates({})) return Verdict::certified;
  return Bisection<Pair>(motion, polygon, tolerance).run(spent);
}

template Verdict judge<VertexTriangle>(const PairMotion<VertexTriangle>&, double, Effort*);
template Verdict judge<EdgeEdge>(const PairMotion<EdgeEdge>&, double, Effort*);
template Verdict judge<VertexEdge2d>(const PairMotion<VertexEdge2d>&, double, Effort*);

}  // namespace bb::audit
