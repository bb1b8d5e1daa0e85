// Limited elements in the host's memory, for states of the host.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/energy/families/limit_family.hpp"
#include "core/exec/host_executor.hpp"

namespace bb::test {

class HostLimit {
 public:
  /// The part outlives it.
  HostLimit(const StrainLimitPart& part, const Positions& rest, bool planar = false,
            Precision precision = Precision::full, exec::Order order = exec::Order::threads)
      : executor_(order),
        bands_(part),
        family_(limited_triangles({executor_, precision}, part, rest, planar)) {}
  HostLimit(const SolidLimitPart& part, const Positions& rest, Precision precision = Precision::full,
            exec::Order order = exec::Order::threads)
      : executor_(order), bands_(part), family_(limited_tetrahedra({executor_, precision}, part, rest)) {}

  LimitFamily& operator*() { return *family_; }
  LimitFamily* operator->() { return family_.get(); }
  std::size_t size() const { return bands_.width.size(); }
  double smallest_gap(std::size_t e) const { return family_->smallest_gap(e); }
  double min_gap() const {
    double out = std::numeric_limits<double>::infinity();
    for (std::size_t e = 0; e < size(); ++e) out = std::min(out, smallest_gap(e));
    return out;
  }
  /// Of the measured state.
  LimitReport report() {
    family_->announce();
    return family_->report();
  }
  std::size_t n_active() const {
    std::size_t n = 0;
    for (std::size_t e = 0; e < size(); ++e) n += smallest_gap(e) < bands_.width[e] ? 1 : 0;
    return n;
  }

  void measure(const Positions& x) { family_->measure(x.data()); }
  /// Measures; the first element at or beyond its limit is beyond().
  std::vector<double> values(const Positions& x, const BarrierFunction& barrier) {
    std::vector<double> out(size());
    beyond_ = ~exec::Key{0};
    family_->measure(x.data(), barrier, out.data(), &beyond_);
    return out;
  }
  exec::Key beyond() const { return beyond_; }
  /// Measures.
  LocalTerms derivatives(const Positions& x, const BarrierFunction& barrier,
                         Projection projection = Projection::psd) {
    LocalTerms out;
    values(x, barrier);
    family_->derivatives(x.data(), projection, out);
    return out;
  }
  void set_kappa(std::vector<double> kappa) { family_->kappa().upload(kappa); }
  std::vector<double> kappa() { return family_->kappa().download(); }
  double step_bound(const Positions& x, const Positions& dx, double alpha_max = 1, double park = 0) {
    family_->look_along(x.data(), dx.data(), park, alpha_max);
    return family_->bound();
  }

 private:
  exec::HostExecutor executor_;
  const StrainBands& bands_;
  std::unique_ptr<LimitFamily> family_;
  exec::Key beyond_ = ~exec::Key{0};
};

/// The same band for all elements of a mass of 1 kg.
inline StrainLimitPart limited(const std::vector<std::array<int, 3>>& triangles, double onset, double width) {
  StrainLimitPart out;
  const std::size_t n = triangles.size();
  out.onset.assign(n, onset), out.width.assign(n, width), out.mass.assign(n, 1);
  out.triangles = triangles;
  return out;
}
inline SolidLimitPart limited(const std::vector<std::array<int, 4>>& tetrahedra, double onset, double width) {
  SolidLimitPart out;
  const std::size_t n = tetrahedra.size();
  out.onset.assign(n, onset), out.width.assign(n, width), out.mass.assign(n, 1);
  out.tetrahedra = tetrahedra;
  return out;
}

}  // namespace bb::test
