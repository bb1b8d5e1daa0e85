// Inertia and weight on an executor: one term for both, whose elements are the vertices.
#include "core/base/archive/archive.hpp"
#include "core/terms/executor/element_terms.hpp"
#include "core/terms/executor/load_kernels.hpp"

namespace bb::exec {
namespace {

class LoadTerm final : public ExecutorTerm {
 public:
  explicit LoadTerm(const ExecutorInputs& inputs)
      : executor_(inputs.executor),
        scene_(inputs.scene),
        matrix_(inputs.matrix),
        n_vertices_(inputs.mass.size()) {
    loads_.inertia.weight.mass = loads_.weight.mass = inputs.mass.data();
  }
  void add_weight() { loads_.has_weight = true; }

  std::string_view name() const override { return "inertia"; }
  TermGroup group() const override { return TermGroup::load; }
  Phase phase() const override { return Phase::assembly; }
  void change_step(const StepColumns& step) override {
    const FamilyStep of = step.of_families();
    loads_.inertia.weight.dt = of.dt, loads_.inertia.weight.c = of.c;
    loads_.inertia.x_tilde = of.x_tilde;
    loads_.weight.set_step(of, gravity_at(scene_, of.t_end));
  }
  void keep(Archive& archive) override {
    if (loads_.has_weight) archive.section("external_force");
  }

  void linearise(const PositionsView& x, const ExecutorContext&, PositionsSpan g) override {
    executor_.each(n_vertices_, LoadGradient{loads_, x.data(), g.data()});
  }
  void add_matrix(const PositionsView&, const HessianRequest&) override {
    const MatrixPart part = matrix_.part();
    executor_.each(n_vertices_,
                   InertiaDiagonal{loads_.inertia, part.row_begin, part.column, matrix_.value()});
  }
  void evaluate(const PositionsView&) override {}
  void add_change(const PositionsView& x, const PositionsView& trial, ExecutorChange& out) override {
    out.lead(n_vertices_, LoadChanges{loads_, x.data(), trial.data()});
  }
  void add_energy(const PositionsView& x, ExecutorEnergy& out) override {
    out.lead(n_vertices_, LoadEnergies{loads_, x.data()});
  }

 private:
  Executor& executor_;
  const Scene& scene_;
  ElementMatrix& matrix_;
  Index n_vertices_;
  Loads loads_{};
};

}  // namespace

void make_inertia_on_executor(const ExecutorInputs& inputs, ExecutorTerms& terms) {
  terms.add(std::make_unique<LoadTerm>(inputs));
}

// Without a vertex there is no term to carry it.
void make_external_force_on_executor(const ExecutorInputs&, ExecutorTerms& terms) {
  if (LoadTerm* loads = terms.find<LoadTerm>()) loads->add_weight();
}

}  // namespace bb::exec
