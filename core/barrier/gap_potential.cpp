#include "core/barrier/gap_potential.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace bb {
namespace {

constexpr int n_nodes = 20;

/// Of Gauss and Legendre on [-1, 1].
struct LegendreRule {
  std::array<double, n_nodes> node, weight;
};

/// The roots of P_20 by Newton's method from cos(pi (i + 3/4)/(n + 1/2)), weights 2/((1 - x^2) P'^2).
LegendreRule legendre_rule() {
  LegendreRule rule{};
  for (int i = 0; i < n_nodes; ++i) {
    long double x = std::cos(std::numbers::pi_v<long double> * (i + 0.75L) / (n_nodes + 0.5L)), slope = 1;
    for (int iteration = 0; iteration < 8; ++iteration) {
      long double before = 1, p = x;
      for (int k = 2; k <= n_nodes; ++k) {
        const long double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p, p = next;
      }
      slope = n_nodes * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    rule.node[static_cast<std::size_t>(i)] = static_cast<double>(x);
    rule.weight[static_cast<std::size_t>(i)] = static_cast<double>(2 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

const LegendreRule& rule() {
  static const LegendreRule of_20 = legendre_rule();
  return of_20;
}

}  // namespace

GapPotential::GapPotential(const BarrierFunction& barrier, const GapStiffness& stiffness)
    : barrier_(barrier), stiffness_(stiffness), joints_(barrier.shape.joints) {
  if (barrier.argument == Argument::squared_gap)
    for (double& joint : joints_) joint = std::sqrt(joint);
}

void GapPotential::integrand(const KappaParts& frozen, double d_hat) {
  const std::size_t n = s_.size();
  width_.assign(n, d_hat);
  for (std::vector<double>* column : {&b_, &db_, &d2b_, &kappa_, &slope_}) column->resize(n);
  barrier_.eval(n, s_.data(), width_.data(), b_.data(), db_.data(), d2b_.data());
  stiffness_.eval(frozen, d_hat, n, s_.data(), kappa_.data(), slope_.data());
}

// -int kappa b' over [low, high].
double GapPotential::part(const KappaParts& frozen, double low, double high, double d_hat, int parts) {
  const double width = (high - low) / parts;
  double out = 0;
  for (int part = parts; part-- > 0;) {
    const double from = low + part * width, to = low + (part + 1) * width;
    const double middle = (from + to) / 2, half = (to - from) / 2;
    s_.resize(n_nodes);
    for (std::size_t i = 0; i < n_nodes; ++i) s_[i] = middle + half * rule().node[i];
    integrand(frozen, d_hat);
    double sum = 0;
    for (std::size_t i = 0; i < n_nodes; ++i) sum -= rule().weight[i] * kappa_[i] * db_[i];
    out += half * sum;
  }
  return out;
}

double GapPotential::panel(const KappaParts& frozen, double low, double high, double d_hat, int parts) {
  double out = 0;
  for (const double joint : joints_) {
    const double cut = joint * d_hat;
    if (!(low < cut && cut < high)) continue;
    out += part(frozen, cut, high, d_hat, parts);
    high = cut;
  }
  return out + part(frozen, low, high, d_hat, parts);
}

// The same over [d, d_hat] with s = d_hat - (d_hat - d) t^2, t from t0 to t1.
double GapPotential::first_part(const KappaParts& frozen, double d, double d_hat, double t0, double t1,
                                int parts) {
  double out = 0;
  for (int part = 0; part < parts; ++part) {
    const double low = t0 + (t1 - t0) * part / parts, half = 0.5 * (t1 - t0) / parts;
    std::array<double, n_nodes> t{};
    s_.resize(n_nodes);
    for (std::size_t i = 0; i < n_nodes; ++i) {
      t[i] = low + half + half * rule().node[i];
      s_[i] = d_hat - (d_hat - d) * t[i] * t[i];
    }
    integrand(frozen, d_hat);
    double sum = 0;
    for (std::size_t i = 0; i < n_nodes; ++i) sum -= rule().weight[i] * kappa_[i] * db_[i] * t[i];
    out += half * sum * 2 * (d_hat - d);
  }
  return out;
}

double GapPotential::first_panel(const KappaParts& frozen, double d, double d_hat, int parts) {
  double out = 0, begin = 0;
  for (const double joint : joints_) {
    const double cut = joint * d_hat;
    if (!(d < cut && cut < d_hat)) continue;
    const double end = std::sqrt((d_hat - cut) / (d_hat - d));
    out += first_part(frozen, d, d_hat, begin, end, parts);
    begin = end;
  }
  return out + first_part(frozen, d, d_hat, begin, 1, parts);
}

// The ends of the panels are d_hat 2^(-j/2), the even ones exactly.
double GapPotential::energy(const KappaParts& frozen, double d, double d_hat, int parts) {
  constexpr double root = std::numbers::sqrt2 / 2;
  double high = d_hat, low = root * d_hat;
  double out = first_panel(frozen, std::max(d, low), d_hat, parts);
  while (d < low) {
    const double next = high / 2;
    high = low, low = next;
    out += panel(frozen, std::max(d, low), high, d_hat, parts);
  }
  return out;
}

void GapPotential::eval(std::size_t n, const double* d, const double* d_hat, const KappaParts* frozen,
                        double* e, double* de, double* d2e) {
  barrier_.eval(n, d, d_hat, e, de, d2e);
  for (std::size_t r = 0; r < n; ++r) {
    if (d[r] >= d_hat[r]) {
      e[r] = de[r] = d2e[r] = 0;
      continue;
    }
    double kappa = 0, slope = 0;
    stiffness_.eval(frozen[r], d_hat[r], 1, &d[r], &kappa, &slope);
    d2e[r] = kappa * d2e[r] + slope * de[r];
    de[r] = kappa * de[r];
    e[r] = energy(frozen[r], d[r], d_hat[r], 1);
  }
}

std::string GapPotential::fault(std::span<const KappaParts> frozen, double d_hat) {
  constexpr int n_gaps = 200;
  constexpr double largest_error = 1e-9;
  for (const KappaParts& pair : frozen) {
    for (int i = 1; i < n_gaps; ++i) {
      const double u = std::pow(double(i) / n_gaps, 3), d = u * d_hat;
      double e = 0, de = 0, d2e = 0;
      eval(1, &d, &d_hat, &pair, &e, &de, &d2e);
      if (!std::isfinite(d2e)) return fmt::format("no finite second derivative at d = {:.3g} d_hat", u);
      if (d2e < 0) return fmt::format("a force that falls as the gap closes, at d = {:.3g} d_hat", u);
      if (de == 0) continue;
      const double halved = energy(pair, d, d_hat, 2), error = std::abs(halved - e) / halved;
      if (!(error <= largest_error)) {
        return fmt::format("a potential whose integral is off by {:.2g} of itself at d = {:.3g} d_hat", error,
                           u);
      }
    }
  }
  return {};
}

}  // namespace bb
