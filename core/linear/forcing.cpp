#include "core/linear/forcing.hpp"

#include <algorithm>

namespace bb {
namespace {
constexpr double largest_eta = 0.1;  // a looser first direction costs more iterations of Newton than it saves
constexpr double eta_with_motion = 1e-3;
constexpr double gamma = 0.9;
}  // namespace

Forcing::Forcing(const ParameterMap& complete)
    : adaptive_(text(complete, "forcing") == "eisenstat_walker"), tol_rel_(number(complete, "tol_rel")) {}

std::vector<Parameter> Forcing::parameters() {
  return {{"forcing", word({"fixed", "eisenstat_walker"}), "eisenstat_walker",
           "tolerance of a solve: tol_rel, or as loose as the residuals of Newton's method allow, 0.1 at "
           "most, 1e-3 while prescribed vertices move"},
          {"tol_rel", open_high(open_low(number_in(0, 1, "1"))), 1e-8,
           "|r| <= tol_rel |b|; the smallest tolerance where forcing chooses it"}};
}

double Forcing::tolerance(double b_norm, RightSide of) {
  if (!adaptive_) return tol_rel_;
  if (of == RightSide::with_motion) {
    last_norm_ = 0;
    return std::max(eta_with_motion, tol_rel_);
  }
  if (b_norm == last_norm_) return eta_;
  if (last_norm_ == 0) {
    eta_ = largest_eta;
  } else {
    const double ratio = b_norm / last_norm_, safeguard = gamma * eta_ * eta_;
    eta_ = gamma * ratio * ratio;
    if (safeguard > largest_eta) eta_ = std::max(eta_, safeguard);
  }
  eta_ = std::max(std::min(eta_, largest_eta), tol_rel_);
  last_norm_ = b_norm;
  return eta_;
}

}  // namespace bb
