// Depth-first bisection of time, earliest span first. A direction m separates during a span when m.w > radius |m| for
// the arms w of all corners at both of its ends: arms are affine in space and in time.
#include "core/audit/obstacle_motion.hpp"

#include <algorithm>

#include "core/audit/closest_point.hpp"
#include "core/audit/quadric.hpp"

namespace bb::audit {
namespace {

constexpr int max_motion_spans = 4000;
constexpr int max_exact_tests = 200;       // of rationals, some tens of microseconds each
constexpr double smallest_move = 0x1p-49;  // a span that moves less of the reach is left to the rationals

mpq_class exact_time(std::int64_t t) {
  return mpq_class(mpz_class(static_cast<long>(t)), mpz_class(static_cast<long>(TimeSpan::one)));
}

template <std::size_t N>
class PastObstacle {
 public:
  using Corners = std::array<Vec3d, N>;
  using ExactCorners = std::array<Rational3, N>;

  PastObstacle(const AuditObstacle& begin, const AuditObstacle& end, const Corners& x0, const Corners& x1)
      : o_(begin), o_end_(end), x0_(x0), x1_(x1), arm_(begin), reach_(arm_.radius) {
    const FloatArms arm_end(end);
    for (std::size_t k = 0; k < N; ++k) {
      begin_[k] = arm_(x0[k]), end_[k] = arm_end(x1[k]);
      reach_ += arm_.reach(x0[k]) + arm_end.reach(x1[k]);
      speed_ = std::max(speed_, (end_[k] - begin_[k]).norm());
    }
  }

  Verdict run() {
    if (separates(middle_direction({}), {})) return Verdict::certified;
    if (beyond_at(0) || beyond_at(TimeSpan::one)) return Verdict::violation;
    TimeSpan stack[64];
    int top = 0;
    stack[top++] = TimeSpan{};
    bool doubt = false;
    for (int spans = 0; top > 0; ++spans) {
      if (spans == max_motion_spans || exact_tests_ >= max_exact_tests) return Verdict::unproven;
      const TimeSpan span = stack[--top];
      const Vec3d m = middle_direction(span);
      if (separates(m, span)) continue;
      const bool last = span.end - span.begin == 1 || speed_ * span.length() <= smallest_move * reach_;
      if ((last || m.norm() < arm_.radius) && beyond_at(span.middle())) return Verdict::violation;
      if (!last) {
        stack[top++] = {span.middle(), span.end};
        stack[top++] = {span.begin, span.middle()};
      } else if (!separates_exactly(m, span)) {
        doubt = true;
      }
    }
    return doubt ? Verdict::unproven : Verdict::certified;
  }

 private:
  Corners at(double t) const {
    Corners w;
    for (std::size_t k = 0; k < N; ++k) w[k] = (1.0 - t) * begin_[k] + t * end_[k];
    return w;
  }
  Vec3d middle_direction(const TimeSpan& span) const {
    return closest_to_origin(at(TimeSpan::fraction(span.middle())));
  }

  bool separates(const Vec3d& m, const TimeSpan& span) const {
    const double least = arm_.radius * m.norm() + quadric_filter * m.norm() * reach_;
    if (!(least < 1e300 && least > quadric_underflow)) return false;
    for (const std::int64_t t : {span.begin, span.end}) {
      for (const Vec3d& corner : at(TimeSpan::fraction(t))) {
        if (!(m.dot(corner) > least)) return false;
      }
    }
    return true;
  }

  /// The arms at that time.
  ExactCorners exact_at(std::int64_t t) const {
    const mpq_class s = exact_time(t), r = 1 - s;
    ExactCorners out;
    for (std::size_t k = 0; k < N; ++k) {
      const Rational3 a = exact_arm(o_, exact(x0_[k])), b = exact_arm(o_end_, exact(x1_[k]));
      for (std::size_t i = 0; i < 3; ++i) out[k][i] = r * a[i] + s * b[i];
    }
    return out;
  }
  bool beyond_at(std::int64_t t) {
    ++exact_tests_;
    return simplex_comes_near(exact_at(t), exact_radius_sq(o_));
  }

  bool separates_exactly(const Vec3d& direction, const TimeSpan& span) {
    ++exact_tests_;
    const Rational3 m = exact(direction);
    const mpq_class least_sq = exact_radius_sq(o_) * dot(m, m);
    for (const std::int64_t t : {span.begin, span.end}) {
      for (const Rational3& arm : exact_at(t)) {
        const mpq_class height = dot(m, arm);
        if (sgn(height) <= 0 || height * height <= least_sq) return false;
      }
    }
    return true;
  }

  const AuditObstacle &o_, &o_end_;
  const Corners &x0_, &x1_;
  FloatArms arm_;
  Corners begin_, end_;  // arms
  double reach_, speed_ = 0.0;
  int exact_tests_ = 0;
};

}  // namespace

template <std::size_t N>
Verdict judge_past_obstacle(const AuditObstacle& begin, const AuditObstacle& end,
                            const std::array<Vec3d, N>& x0, const std::array<Vec3d, N>& x1) {
  return PastObstacle<N>(begin, end, x0, x1).run();
}

template Verdict judge_past_obstacle<2>(const AuditObstacle&, const AuditObstacle&,
                                        const std::array<Vec3d, 2>&, const std::array<Vec3d, 2>&);
template Verdict judge_past_obstacle<3>(const AuditObstacle&, const AuditObstacle&,
                                        const std::array<Vec3d, 3>&, const std::array<Vec3d, 3>&);

}  // namespace bb::audit
