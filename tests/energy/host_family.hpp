// A family of elements in the host's memory, for states of the host.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/base/archive/archive.hpp"
#include "core/energy/families/families.hpp"
#include "core/exec/host_executor.hpp"

namespace bb::test {

class HostFamily {
 public:
  using Make = std::function<MadeFamily(const FamilyPlace&)>;
  explicit HostFamily(const Make& make, Precision precision = Precision::full,
                      exec::Order order = exec::Order::threads)
      : executor_(order), family_(make({executor_, precision})) {}
  ElementFamily& operator*() { return *family_; }
  ElementFamily* operator->() { return family_.get(); }
  std::size_t size() const { return static_cast<std::size_t>(family_->size()); }
  std::vector<double> values(const Positions& x) const {
    std::vector<double> out(size());
    family_->values(x.data(), out.data());
    return out;
  }
  void derivatives(const Positions& x, Projection projection, LocalTerms& out) const {
    family_->derivatives(x.data(), projection, out);
  }
  /// What elements remember, as a checkpoint has it.
  std::vector<double> memory() {
    Archive written;
    family_->keep(written);
    std::vector<double> now, next;
    if (written.bytes().empty()) return now;
    Archive(written.bytes())(now, next);
    return now;
  }
  std::vector<std::size_t> cusps(const Positions& x) const { return family_->cusps(x.data()); }
  /// Steps of dt (s) that end at x, while what is given over time is that of t (s).
  void step(const Positions& x, double dt, int n = 1, double t = 0) {
    for (int i = 0; i < n; ++i) {
      family_->end_step(x.data(), dt);
      family_->begin_step({.t_end = t});
    }
  }

 private:
  exec::HostExecutor executor_;
  std::unique_ptr<ElementFamily> family_;
};

/// Membranes that rest at `rest`. The part outlives what is made.
inline HostFamily::Make membranes_of(const MembranePart& part, const Positions& rest, bool planar = false) {
  return
      [&part, rest, planar](const FamilyPlace& place) { return membrane_family(place, part, rest, planar); };
}
/// A scene of a body at rest there, whose rest lengths follow these factors.
inline Scene scaled_rest(const Positions& rest, std::vector<ShrinkKey> factors) {
  Scene scene;
  scene.rest = rest;
  scene.rest_motions = {{0, static_cast<int>(rest.cols()), nullptr, std::move(factors)}};
  return scene;
}
/// Springs of stiffness k (N/m) that rest at x. The edges outlive what is made.
inline HostFamily::Make springs_of(const std::vector<std::array<int, 2>>& edges, const Positions& x,
                                   const std::vector<double>& k) {
  return [&edges, x, k](const FamilyPlace& place) {
    return spring_family(place, {}, edges, k, lengths_of(edges, x));
  };
}
/// The part outlives what is made.
inline HostFamily::Make hinges_of(const HingePart& part) {
  return [&part](const FamilyPlace& place) { return hinge_family(place, part); };
}

}  // namespace bb::test
