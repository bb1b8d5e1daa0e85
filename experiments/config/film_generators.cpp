#include "experiments/config/film_generators.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math/error.hpp"

namespace bb {
namespace {

/// From 0 at the time 0 to 1 in the middle of a period and back, without a jump of the velocity.
double swing(double t, double period) { return 0.5 * (1 - std::cos(2 * std::numbers::pi * t / period)); }

/// Lines along z between two heights become arcs of their length in the x-z plane, of which the z axis keeps its length; what is above
/// goes on straight.
Positions bend(const Positions& x, const ParameterMap& p, double t) {
  const double from = number(p, "from_m"), length = number(p, "to_m") - from;
  const double angle = number(p, "angle_rad") * swing(t, number(p, "period_s"));
  if (!(length > 0)) {
    throw ConfigError("to_m", fmt::format("{}", number(p, "to_m")),
                      fmt::format("a number > {}, from_m (m)", from));
  }
  if (angle == 0) return x;
  const double radius = length / angle;
  Positions out = x;
  for (Eigen::Index v = 0; v < x.cols(); ++v) {
    const double along = std::clamp((x(2, v) - from) / length, 0.0, 1.0), turned = along * angle;
    const double over = x(2, v) - from - along * length;  // below 0 under the arc, above 0 beyond it
    const double c = std::cos(turned), s = std::sin(turned), out_of_axis = x(0, v);
    out(0, v) = radius * (1 - c) + c * out_of_axis + s * over;
    out(2, v) = from + radius * s - s * out_of_axis + c * over;
  }
  return out;
}

/// Cross-sections turn about z, in proportion to their height above one that stays.
Positions twist(const Positions& x, const ParameterMap& p, double t) {
  const double rate = number(p, "turn_rad_per_m") * swing(t, number(p, "period_s"));
  Positions out = x;
  for (Eigen::Index v = 0; v < x.cols(); ++v) {
    const double angle = rate * (x(2, v) - number(p, "from_m")), c = std::cos(angle), s = std::sin(angle);
    out(0, v) = c * x(0, v) - s * x(1, v);
    out(1, v) = s * x(0, v) + c * x(1, v);
  }
  return out;
}

/// Every coordinate times a factor of its own.
Positions grow(const Positions& x, const ParameterMap& p, double t) {
  const double share = swing(t, number(p, "period_s"));
  Positions out = x;
  int k = 0;
  for (const char* factor : {"factor_x", "factor_y", "factor_z"})
    out.row(k++) *= 1 + share * (number(p, factor) - 1);
  return out;
}

FilmGenerator with_frames(FilmGenerator generator) {
  generator.parameters.push_back({"n_frames", count(2, 100000), 61, "frames, at equal times from 0 on"});
  generator.parameters.push_back({"duration_s", positive("s"), 1, "time of the last frame"});
  return generator;
}

}  // namespace

const Registry<FilmGenerator>& film_generators() {
  static const Registry<FilmGenerator> list(
      {with_frames(
           {"bend",
            "what lies between two heights curves into an arc in the x-z plane and back, the rest follows",
            {{"angle_rad", any_number("rad"), 1, "turn of what is above, in the middle of a period"},
             {"period_s", positive("s"), 1, "time from straight to straight"},
             {"from_m", any_number("m"), 0, "height z at which the arc begins"},
             {"to_m", any_number("m"), 1, "height at which it ends; above from_m"}},
            bend}),
       with_frames({"twist",
                    "cross-sections turn about z and back, the more the higher they are",
                    {{"turn_rad_per_m", any_number("rad/m"), 1, "in the middle of a period"},
                     {"period_s", positive("s"), 1, "time from straight to straight"},
                     {"from_m", any_number("m"), 0, "height z that does not turn"}},
                    twist}),
       with_frames({"grow",
                    "coordinates grow about the origin by factors, and go back",
                    {{"factor_x", positive("1"), 1, "of x, in the middle of a period"},
                     {"factor_y", positive("1"), 1, "of y"},
                     {"factor_z", positive("1"), 1, "of z"},
                     {"period_s", positive("s"), 1, "time from the start and back to it"}},
                    grow})});
  return list;
}

}  // namespace bb
