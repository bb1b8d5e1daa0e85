// Work of the weight: -f . (x - x_n), one element a vertex. No Hessian.
#include <algorithm>
#include <numeric>

#include "core/energy/vertex_loads.hpp"
#include "core/math/parallel.hpp"
#include "core/terms/registry.hpp"

namespace bb {
namespace {

class ExternalForce final : public Term {
 public:
  explicit ExternalForce(const Scene& scene) : scene_(scene), vertices_(scene.mass.size()) {
    std::iota(vertices_.begin(), vertices_.end(), 0);
    TermFamily& family = families_.emplace_back();
    family.stencils = {1, vertices_};
    family.local.energy.resize(vertices_.size());
    family.local.grad.resize(3 * vertices_.size());
    family.trial_energy.resize(vertices_.size());
  }

  std::string_view name() const override { return "external_force"; }
  TermGroup group() const override { return TermGroup::load; }
  Phase phase() const override { return Phase::assembly; }
  bool on_vertices() const override { return true; }

  void begin_step(const StepFrame& frame, PhaseClock&) override {
    x_n_ = frame.x_n;
    change_frame(frame);
  }
  // Gravity may depend on when the step ends.
  void change_frame(const StepFrame& frame) override {
    force_.resize(3, x_n_.cols());
    const Vec3d gravity = gravity_at(scene_, frame.t_end);
    for (Eigen::Index i = 0; i < x_n_.cols(); ++i) {
      force_.col(i) = weight_force(frame.load_factor, scene_.mass[static_cast<std::size_t>(i)], gravity);
    }
    Positions::Map(families_[0].local.grad.data(), 3, x_n_.cols()) = -force_;
  }

  void linearise(const PositionsView& x, const TermContext&) override {
    fill_energies(x, families_[0].local.energy);
  }
  void evaluate(const PositionsView& x) override { fill_energies(x, families_[0].trial_energy); }
  void change(const PositionsView& x0, const PositionsView& x1, EnergyParts& out) const override {
    const std::size_t start = out.size();
    out.resize(start + vertices_.size());
    parallel_items(x0.cols(), block_items, [&](Eigen::Index i) {
      const Vec3d force = force_.col(i), step = x1.col(i) - x0.col(i);
      const auto part = work_change(force, step);
      out[start + static_cast<std::size_t>(i)] = {part.change, part.magnitude};
    });
  }

 private:
  void fill_energies(const PositionsView& x, std::vector<double>& energy) const {
    parallel_items(x.cols(), block_items, [&](Eigen::Index i) {
      energy[static_cast<std::size_t>(i)] = -force_.col(i).dot(x.col(i) - x_n_.col(i));
    });
  }

  const Scene& scene_;
  std::vector<int> vertices_;
  Positions x_n_, force_;  // m, N
};

}  // namespace

PlanItem needs_external_force(const TermNeeds& needs) {
  const Scene& scene = needs.scene;
  const bool some =
      !scene.gravity.isZero(0) || std::any_of(scene.gravity_keys.begin(), scene.gravity_keys.end(),
                                              [](const GravityKey& key) { return !key.value.isZero(0); });
  return plan_item(some, "the scene has gravity", "no gravity");
}

void make_external_force(const TermInputs& inputs, TermList& terms) {
  terms.add(std::make_unique<ExternalForce>(inputs.scene));
}

}  // namespace bb
