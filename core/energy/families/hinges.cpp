// Bending hinges: their columns, and rest angles that creep.
#include "core/energy/families/hinges.hpp"

#include "core/energy/element_loop.hpp"
#include "core/energy/families/families.hpp"
#include "core/energy/families/family_of.hpp"
#include "core/energy/families/rest_memory.hpp"

namespace bb {
namespace {

template <class Elements>
class HingeFamily final : public FamilyOf<Elements> {
  using Base = FamilyOf<Elements>;
  using Base::elements_, Base::place_;

 public:
  HingeFamily(const FamilyPlace& place, const HingePart& part)
      : Base(place, "hinge vertices", std::span(part.hinges)),
        stiffness_(place.executor, "hinge stiffness"),
        growing_(place.executor, "hinge exponential parts"),
        creep_(place.executor, "hinge creep"),
        rest_angle_(place.executor, "hinge rest angles"),
        creeps_(any_positive(part.creep)) {
    stiffness_.upload(part.stiffness);
    rest_angle_.set(part.rest_angle);
    if (creeps_) upload_pair(part.yield, part.creep, creep_);
    elements_.stiffness = stiffness_.data();
    elements_.rest_angle = rest_angle_.data();
    if constexpr (std::is_same_v<Elements, StiffeningHinges>) {
      upload_pair(part.exponential, part.exponent, growing_);
      elements_.exponential = growing_.data(), elements_.exponent = growing_.data() + elements_.n;
    }
  }

  void begin_step(const FamilyStep&) override { rest_angle_.begin_step(); }
  bool flows() const override { return creeps_; }
  void end_step(const double* x, double dt) override {
    place_.executor.each(elements_.n, FlowHinges{elements_, creep_.data(), creep_.data() + elements_.n, x, dt,
                                                 rest_angle_.flow()});
  }
  void keep(Archive& archive) override {
    if (creeps_) rest_angle_.keep(archive);
  }

 private:
  exec::Buffer<double> stiffness_, growing_, creep_;  // growing_: [2, n] J, 1/rad; creep_: [2, n] rad, 1/s
  RestMemory rest_angle_;
  bool creeps_;
};

}  // namespace

MadeFamily hinge_family(const FamilyPlace& place, const HingePart& part) {
  const std::size_t n = part.hinges.size();
  check_column("hinge/stiffness", n, part.stiffness, false);
  check_column("hinge/rest_angle", n, part.rest_angle, false);
  if (any_positive(part.creep)) {
    check_column("hinge/yield", n, part.yield, false);
    check_column("hinge/creep", n, part.creep, false);
  }
  if (!any_positive(part.exponential)) return std::make_unique<HingeFamily<Hinges>>(place, part);
  check_column("hinge/exponential", n, part.exponential, false);
  check_column("hinge/exponent", n, part.exponent, true);
  return std::make_unique<HingeFamily<StiffeningHinges>>(place, part);
}

}  // namespace bb
