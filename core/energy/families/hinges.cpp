// Bending hinges: their columns, and rest angles that move and creep.
#include "core/energy/families/hinges.hpp"

#include <cmath>
#include <numbers>

#include "core/energy/element_loop.hpp"
#include "core/energy/families/families.hpp"
#include "core/energy/families/family_of.hpp"
#include "core/energy/families/rest_memory.hpp"

namespace bb {
namespace {

/// By how much angles of a rest shape that moves differ from those of its start.
std::vector<double> moved_angles(const HingePart& part, const MovingRest& rest) {
  const auto angle = [](const Positions& x, const std::array<int, 4>& hinge) {
    Vec3d p[4];
    for (std::size_t k = 0; k < 4; ++k) p[k] = x.col(hinge[k]);
    return hinge_angle(p);
  };
  std::vector<double> out;
  for (const auto& hinge : part.hinges) {
    out.push_back(
        std::remainder(angle(rest.now(), hinge) - angle(rest.start(), hinge), 2 * std::numbers::pi));
  }
  return out;
}

template <class Elements>
class HingeFamily final : public FamilyOf<Elements> {
  using Base = FamilyOf<Elements>;
  using Base::elements_, Base::place_;

 public:
  HingeFamily(const FamilyPlace& place, const HingePart& part, MovingRest rest)
      : Base(place, "hinge vertices", std::span(part.hinges)),
        part_(part),
        rest_(std::move(rest)),
        stiffness_(place.executor, "hinge stiffness"),
        growing_(place.executor, "hinge exponential parts"),
        creep_(place.executor, "hinge creep"),
        moved_(place.executor, "hinge angles that move"),
        rest_angle_(place.executor, "hinge angles of the step", rest_.moves() ? elements_.n : 0),
        crept_(place.executor, "hinge rest angles"),
        creeps_(any_positive(part.creep)) {
    stiffness_.upload(part.stiffness);
    crept_.set(part.rest_angle);
    if (creeps_) upload_pair(part.yield, part.creep, creep_);
    elements_.stiffness = stiffness_.data();
    elements_.rest_angle = rest_.moves() ? rest_angle_.data() : crept_.data();
    if constexpr (std::is_same_v<Elements, StiffeningHinges>) {
      upload_pair(part.exponential, part.exponent, growing_);
      elements_.exponential = growing_.data(), elements_.exponent = growing_.data() + elements_.n;
    }
    place_angles(0);
  }

  void begin_step(const FamilyStep& step) override {
    crept_.begin_step();
    place_angles(step.t_end);
  }
  void change_step(const FamilyStep& step) override { place_angles(step.t_end); }
  bool flows() const override { return creeps_; }
  void end_step(const double* x, double dt) override {
    place_.executor.each(elements_.n,
                         FlowHinges{elements_, creep_.data(), creep_.data() + elements_.n,
                                    rest_.moves() ? moved_.data() : nullptr, x, dt, crept_.flow()});
  }
  void keep(Archive& archive) override {
    if (creeps_) crept_.keep(archive);
  }

 private:
  void place_angles(double t) {
    if (!rest_.moves()) return;
    if (rest_.move(t)) moved_.upload(moved_angles(part_, rest_));
    place_.executor.each(elements_.n, PlaceHinges{crept_.data(), moved_.data(), rest_angle_.data()});
  }

  const HingePart& part_;
  MovingRest rest_;
  exec::Buffer<double> stiffness_, growing_, creep_;  // growing_: [2, n] J, 1/rad; creep_: [2, n] rad, 1/s
  exec::Buffer<double> moved_, rest_angle_;           // [n] rad; empty: rest shapes stay
  RestMemory crept_;                                  // [n] rad
  bool creeps_;
};

}  // namespace

MadeFamily hinge_family(const FamilyPlace& place, const HingePart& part, MovingRest rest) {
  const std::size_t n = part.hinges.size();
  check_column("hinge/stiffness", n, part.stiffness, false);
  check_column("hinge/rest_angle", n, part.rest_angle, false);
  if (any_positive(part.creep)) {
    check_column("hinge/yield", n, part.yield, false);
    check_column("hinge/creep", n, part.creep, false);
  }
  if (!any_positive(part.exponential)) {
    return std::make_unique<HingeFamily<Hinges>>(place, part, std::move(rest));
  }
  check_column("hinge/exponential", n, part.exponential, false);
  check_column("hinge/exponent", n, part.exponent, true);
  return std::make_unique<HingeFamily<StiffeningHinges>>(place, part, std::move(rest));
}

}  // namespace bb
