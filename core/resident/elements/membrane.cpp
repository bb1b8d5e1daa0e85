// Membranes on an executor: one term a model in use.
#include "core/energy/membrane_batch.hpp"
#include "core/math/error.hpp"
#include "core/resident/elements/element_columns.hpp"
#include "core/resident/elements/element_term.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/family_kernels.hpp"
#include "core/resident/elements/rest_memory.hpp"

namespace bb::resident {
namespace {

template <class Elements>
class MembraneTerm final : public TermOf<Elements> {
 public:
  MembraneTerm(const ResidentInputs& inputs, const MembraneBatch& batch, const MembranePart& part)
      : TermOf<Elements>(inputs, "membrane", batch.vertices()),
        triangles_(inputs.executor, "membrane", batch.vertices(), batch.rests()),
        lame_(inputs.executor, "membrane Lame parameters"),
        keys_(part.shrink_keys.lists),
        given_(inputs.executor, "membrane given shapes"),
        creep_(inputs.executor, "membrane creep"),
        factor_(inputs.executor, "factors of shrinkage"),
        list_(inputs.executor, "membrane shrinkage"),
        plastic_(inputs.executor, "membrane plastic parts"),
        creeps_(!part.creep.empty()) {
    upload_pair(part.lame_mu, part.lame_lambda, lame_);
    Elements& elements = this->elements_;
    elements.of = triangles_.vertex.data();
    elements.n = static_cast<Index>(batch.size());
    elements.rest = triangles_.rest();
    elements.lame_mu = lame_.data();
    elements.lame_lambda = lame_.data() + elements.n;
    if (creeps_ || !part.shrink_keys.list.empty()) let_change(part);
  }

  void begin_step(const ResidentFrame& frame) override {
    plastic_.begin_step();
    change_frame(frame);
  }
  void change_frame(const ResidentFrame& frame) override {
    dt_ = frame.dt;
    if (given_.size() == 0) return;
    std::vector<double> factor;
    for (const auto& keys : keys_) factor.push_back(value_at(keys, frame.t_end));
    factor_.upload(factor);
    const Index n = this->size();
    this->executor_.each(
        n, PlaceTriangles{given_.data(), list_.size() > 0 ? list_.data() : nullptr, factor_.data(),
                          creeps_ ? plastic_.data() : nullptr, n, triangles_.numbers.data()});
  }
  void end_step(const Column& x, PhaseClock& clock) override {
    if (!creeps_) return;
    const ScopedPhase timer(clock, Phase::elastic);
    const Index n = this->size();
    this->executor_.each(n, FlowTriangles{this->elements_, this->elements_.rest, creep_.data(),
                                          creep_.data() + n, x.data(), dt_, plastic_.flow()});
  }
  void keep(Archive& archive) override {
    this->ResidentTerm::keep(archive);
    if (creeps_) plastic_.keep(archive);
  }

 private:
  /// What rest shapes that shrink over time or creep are made from in every step.
  void let_change(const MembranePart& part) {
    given_.copy_from(triangles_.numbers);
    std::vector<int> list = part.shrink_keys.list;
    if (!list.empty()) list.resize(part.triangles.size(), -1);
    list_.upload(list);
    if (!creeps_) return;
    upload_pair(part.yield, part.creep, creep_);
    std::vector<double> plastic;
    for (std::size_t e = 0; e < part.triangles.size(); ++e) plastic.insert(plastic.end(), {1, 0, 0, 1});
    plastic_.set(plastic);
  }

  TriangleColumns triangles_;
  Buffer<double> lame_;
  const std::vector<std::vector<ShrinkKey>>& keys_;
  Buffer<double> given_;   // [5, n] rest shapes before any change; empty: they stay
  Buffer<double> creep_;   // [2, n] yield, rate
  Buffer<double> factor_;  // of each list of keys
  Buffer<int> list_;
  RestMemory plastic_;  // [4 n] inverses of plastic parts, triangle by triangle
  bool creeps_;
  double dt_ = 0;  // s, of the step
};

template <class Model>
void add_model(const ResidentInputs& inputs, const MembraneBatch& batch, const MembranePart& part,
               ResidentTermList& terms) {
  if (inputs.scene.planar) {
    terms.add(std::make_unique<MembraneTerm<PlanarMembrane<Model>>>(inputs, batch, part));
  } else {
    terms.add(std::make_unique<MembraneTerm<SpaceMembrane<Model>>>(inputs, batch, part));
  }
}

void add_part(const ResidentInputs& inputs, const MembranePart& part, ResidentTermList& terms) {
  MembraneBatch batch(part.model, part.triangles, inputs.scene.rest, part.lame_mu, part.lame_lambda,
                      inputs.scene.planar, part.warp);
  if (!part.shrink.empty()) batch.scale_rest(part.shrink);
#define ENTRY(id, ...) \
  if (part.model == #id) return add_model<membrane::id>(inputs, batch, part, terms);
#include "core/energy/registry.inc"
#undef ENTRY
  throw ConfigError("membrane/model", part.model, "a model of core/energy/registry.inc");
}

}  // namespace

void make_resident_membrane(const ResidentInputs& inputs, ResidentTermList& terms) {
  for (const MembranePart& part : inputs.scene.membranes) {
    if (!part.triangles.empty()) add_part(inputs, part, terms);
  }
}

}  // namespace bb::resident
