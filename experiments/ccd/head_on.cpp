#include "experiments/ccd/head_on.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <type_traits>

#include "core/audit/predicates.hpp"
#include "core/geometry/accd.hpp"

namespace bb::ccd {
namespace {

constexpr double offsets[] = {0, 10, 1000};
constexpr double gaps[] = {1e-5, 1e-6, 1e-7, 1e-12, 1e-14};
constexpr double smallest_float_gap = 1e-7;  // below it every start is rounded away

/// A point `gap` above an inner point of a triangle (columns 1 to 3), its end below it; m.
struct Sweep {
  Mat<double, 3, 4> x0, x1;
};

Vec3d random_in_ball(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (;;) {
    const Vec3d x(uniform(random), uniform(random), uniform(random));
    if (x.squaredNorm() <= 1 && x.squaredNorm() > 1e-4) return x;
  }
}

/// Triangles whose normal is no accident of rounding: sine of a corner at least 0.1.
Sweep random_sweep(std::mt19937_64& random, double offset, double gap) {
  std::uniform_real_distribution<double> uniform(0.1, 1);
  Vec3d a, b, c, normal;
  do {
    a = 0.5 * random_in_ball(random), b = 0.5 * random_in_ball(random), c = 0.5 * random_in_ball(random);
    normal = (b - a).cross(c - a);
  } while (normal.norm() < 0.1 * (b - a).norm() * (c - a).norm());
  const Vec3d n = normal.normalized(), away = offset * random_in_ball(random).normalized();
  const double wa = uniform(random), wb = uniform(random), wc = uniform(random);
  const Vec3d inner = (wa * a + wb * b + wc * c) / (wa + wb + wc);
  Sweep out;
  out.x0 << inner + gap * n, a, b, c;
  out.x1 << inner - uniform(random) * n, a, b, c;
  out.x0.colwise() += away;
  out.x1.colwise() += away;
  return out;
}

/// Whether the point is strictly on the side of the normal, by exact signs.
template <class T>
bool above(const Mat<T, 3, 4>& x) {
  const Mat<double, 3, 4> exact = x.template cast<double>();
  return audit::orient3d(exact.col(1), exact.col(2), exact.col(3), exact.col(0)) > 0;
}

template <class T>
HeadOn sweep_all(int sweeps, std::uint64_t seed, double offset, double gap) {
  HeadOn out;
  out.precision = std::is_same_v<T, float> ? "float" : "double";
  out.offset = offset;
  out.gap = gap;
  out.sweeps = sweeps;
  std::mt19937_64 random(seed);
  for (int k = 0; k < sweeps; ++k) {
    const Sweep sweep = random_sweep(random, offset, gap);
    const Mat<T, 3, 4> x0 = sweep.x0.cast<T>(), x1 = sweep.x1.cast<T>();
    if (!above<T>(x0)) {
      ++out.start_wrong;
      continue;
    }
    const auto result = accd<PairKind::point_triangle, T>(x0, x1, T(0), T(0));
    const Mat<T, 3, 4> committed = x0 + result.toi * (x1 - x0);
    out.refused += result.toi == 0;
    out.capped += result.capped;
    out.crossed += !above<T>(committed);
  }
  return out;
}

}  // namespace

std::vector<HeadOn> head_on_sweeps(int sweeps, std::uint64_t seed) {
  std::vector<HeadOn> out;
  for (const double offset : offsets) {
    for (const double gap : gaps) {
      if (gap >= smallest_float_gap) out.push_back(sweep_all<float>(sweeps, seed, offset, gap));
    }
  }
  for (const double offset : offsets) {
    for (const double gap : gaps) out.push_back(sweep_all<double>(sweeps, seed, offset, gap));
  }
  return out;
}

bool any_crossed(const std::vector<HeadOn>& rows) {
  return std::any_of(rows.begin(), rows.end(), [](const HeadOn& r) { return r.crossed > 0; });
}

std::string head_on_table(const std::vector<HeadOn>& rows) {
  std::string out = fmt::format("{:<9} {:>9} {:>7} {:>8} {:>11} {:>8} {:>7} {:>8}\n", "precision", "offset m",
                                "gap m", "sweeps", "start wrong", "refused", "capped", "crossed");
  for (const HeadOn& r : rows) {
    out += fmt::format("{:<9} {:>9g} {:>7g} {:>8} {:>11} {:>8} {:>7} {:>8}\n", r.precision, r.offset, r.gap,
                       r.sweeps, r.start_wrong, r.refused, r.capped, r.crossed);
  }
  return out;
}

}  // namespace bb::ccd
