// Hinges on an executor, with a part that grows or without.
#include <algorithm>

#include "core/energy/hinge_batch.hpp"
#include "core/resident/elements/element_term.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/family_kernels.hpp"
#include "core/resident/elements/rest_memory.hpp"

namespace bb::resident {
namespace {

bool any_positive(const std::vector<double>& column) {
  return std::any_of(column.begin(), column.end(), [](double value) { return value > 0; });
}

template <class Elements>
class HingeTerm final : public TermOf<Elements> {
  using Base = TermOf<Elements>;
  using Base::elements_, Base::executor_, Base::size;

 public:
  HingeTerm(const ResidentInputs& inputs, const HingeBatch& batch)
      : Base(inputs, "hinges", batch.vertices()),
        vertex_(executor_, "hinge vertices"),
        stiffness_(executor_, "hinge stiffness"),
        growing_(executor_, "hinge exponential parts"),
        creep_(executor_, "hinge creep"),
        rest_angle_(executor_, "hinge rest angles"),
        creeps_(any_positive(inputs.scene.hinges.creep)) {
    const HingePart& part = inputs.scene.hinges;
    vertex_.upload(to_columns(batch.vertices(), 4));
    stiffness_.upload(part.stiffness);
    rest_angle_.set(part.rest_angle);
    if (creeps_) upload_pair(part.yield, part.creep, creep_);
    elements_.of = vertex_.data();
    elements_.n = size();
    elements_.stiffness = stiffness_.data();
    elements_.rest_angle = rest_angle_.data();
    if constexpr (std::is_same_v<Elements, StiffeningHinges>) {
      upload_pair(part.exponential, part.exponent, growing_);
      elements_.exponential = growing_.data(), elements_.exponent = growing_.data() + size();
    }
  }

  void begin_step(const ResidentFrame& frame) override {
    rest_angle_.begin_step();
    this->change_frame(frame);
  }
  void change_frame(const ResidentFrame& frame) override { dt_ = frame.dt; }
  void end_step(const Column& x, PhaseClock& clock) override {
    if (!creeps_) return;
    const ScopedPhase timer(clock, Phase::elastic);
    executor_.each(size(), FlowHinges{elements_, creep_.data(), creep_.data() + size(), x.data(), dt_,
                                      rest_angle_.flow()});
  }
  void keep(Archive& archive) override {
    this->ResidentTerm::keep(archive);
    if (creeps_) rest_angle_.keep(archive);
  }

 private:
  Buffer<int> vertex_;
  Buffer<double> stiffness_, growing_, creep_;  // growing_: [2, n] J, 1/rad; creep_: [2, n] rad, 1/s
  RestMemory rest_angle_;
  bool creeps_;
  double dt_ = 0;  // s, of the step
};

}  // namespace

void make_resident_hinges(const ResidentInputs& inputs, ResidentTermList& terms) {
  const HingePart& part = inputs.scene.hinges;
  const HingeBatch batch(part.hinges, part.stiffness, part.rest_angle);
  if (any_positive(part.exponential)) {
    terms.add(std::make_unique<HingeTerm<StiffeningHinges>>(inputs, batch));
  } else {
    terms.add(std::make_unique<HingeTerm<Hinges>>(inputs, batch));
  }
}

}  // namespace bb::resident
