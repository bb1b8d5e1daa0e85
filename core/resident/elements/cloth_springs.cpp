// Springs of cloth on an executor.
#include <algorithm>

#include "core/energy/element_loop.hpp"
#include "core/resident/elements/cloth_spring_kernels.hpp"
#include "core/resident/elements/element_term.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/rest_memory.hpp"

namespace bb::resident {
namespace {

class ClothSpringTerm final : public TermOf<ClothSprings> {
 public:
  explicit ClothSpringTerm(const ResidentInputs& inputs)
      : TermOf(inputs, "cloth_springs", flat(inputs.scene.cloth_springs.pairs)),
        part_(inputs.scene.cloth_springs),
        vertex_(executor_, "cloth spring vertices"),
        law_(executor_, "cloth spring stiffnesses"),
        given_(executor_, "cloth spring lengths"),
        rest_(executor_, "cloth spring rest lengths", size()),
        creep_(executor_, "cloth spring creep"),
        list_(executor_, "cloth spring shrinkage"),
        factor_(executor_, "factors of shrinkage"),
        ratio_(executor_, "cloth spring ratios"),
        creeps_(std::any_of(part_.creep.begin(), part_.creep.end(), [](double rate) { return rate > 0; })) {
    vertex_.upload(to_columns<int>(flat(part_.pairs), 2));
    std::vector<double> law;
    for (const auto* column : {&part_.tension, &part_.tension_growing, &part_.compression,
                               &part_.compression_growing, &part_.exponent}) {
      law.insert(law.end(), column->begin(), column->end());
    }
    law_.upload(law);
    given_.upload(part_.rest_length);
    upload_pair(part_.yield, part_.creep, creep_);
    std::vector<int> list = part_.shrink_keys.list;
    if (!list.empty()) list.resize(part_.pairs.size(), -1);
    list_.upload(list);
    ratio_.set(std::vector<double>(part_.pairs.size(), 1.0));
    elements_.of = vertex_.data();
    elements_.n = size();
    elements_.law = law_.data();
    elements_.rest_length = rest_.data();
  }

  void begin_step(const ResidentFrame& frame) override {
    ratio_.begin_step();
    change_frame(frame);
  }
  void change_frame(const ResidentFrame& frame) override {
    dt_ = frame.dt;
    std::vector<double> factor;
    for (const auto& keys : part_.shrink_keys.lists) factor.push_back(value_at(keys, frame.t_end));
    factor_.upload(factor);
    executor_.each(size(), PlaceClothSprings{lengths(), ratio_.data(), rest_.data()});
  }
  void end_step(const Column& x, PhaseClock& clock) override {
    if (!creeps_) return;
    const ScopedPhase timer(clock, Phase::elastic);
    executor_.each(size(), FlowClothSprings{elements_, lengths(), creep_.data(), creep_.data() + size(),
                                            x.data(), dt_, ratio_.flow()});
  }
  void keep(Archive& archive) override {
    ResidentTerm::keep(archive);
    if (creeps_) ratio_.keep(archive);
  }

 private:
  GivenLengths lengths() const {
    return {given_.data(), list_.size() > 0 ? list_.data() : nullptr, factor_.data()};
  }

  const ClothSpringPart& part_;
  Buffer<int> vertex_;
  Buffer<double> law_, given_, rest_;
  Buffer<double> creep_;  // [2, n] yield, rate
  Buffer<int> list_;
  Buffer<double> factor_;
  RestMemory ratio_;
  bool creeps_;
  double dt_ = 0;  // s, of the step
};

}  // namespace

void make_resident_cloth_springs(const ResidentInputs& inputs, ResidentTermList& terms) {
  terms.add(std::make_unique<ClothSpringTerm>(inputs));
}

}  // namespace bb::resident
