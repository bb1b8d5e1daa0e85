// distance, ccd, intersects: the geometry of one pair.
#include "core/audit/segment_triangle.hpp"
#include "experiments/eval/any_scale.hpp"
#include "experiments/eval/kinds.hpp"
#include "experiments/eval/pair_field.hpp"

namespace bb::eval {

template <class T>
Answer answer::distance(Query& q) {
  return with_pair(q, [&q]<PairKind K>(PairTag<K>) {
    constexpr int n = pair_points(K);
    const Mat<T, 3, n> x = q.points<T>("points", n);
    q.finish();
    const auto [scale, closest] = closest_at_any_scale<K, T>(x);
    Answer a;
    a.number("d", static_cast<double>(scale.back(closest.d)));
    a.vector("weights", closest.weights);
    a.word("region", region_name(closest.region));
    return a;
  });
}

template <class T>
Answer answer::ccd(Query& q) {
  return with_pair(q, [&q]<PairKind K>(PairTag<K>) {
    constexpr int n = pair_points(K);
    const Mat<T, 3, n> x0 = q.points<T>("points_t0", n), x1 = q.points<T>("points_t1", n);
    const T offset = static_cast<T>(q.number_or("offset", kNonNegative, 0));
    const T park = static_cast<T>(q.number_or("park", kNonNegative, 0));
    q.finish();
    const AccdResult<T> result = accd_at_any_scale<K, T>(x0, x1, offset, park);
    Answer a;
    a.flag("hit", result.hit);
    a.number("toi", static_cast<double>(result.toi));
    if (result.overlap_at_start) a.status("overlap_at_start");
    return a;
  });
}

template <class T>
Answer answer::intersects(Query& q) {
  const auto s = q.points<double>("segment", 2);
  const auto t = q.points<double>("triangle", 3);
  q.finish();
  const audit::Crossing found = audit::segment_triangle(s.col(0), s.col(1), t.col(0), t.col(1), t.col(2));
  Answer a;
  a.flag("crossing", found == audit::Crossing::crossing);
  a.flag("touch", found == audit::Crossing::touch);
  return a;
}

BB_EVAL_KIND(distance);
BB_EVAL_KIND(ccd);
BB_EVAL_KIND(intersects);

}  // namespace bb::eval
