// Inertia: 1/(2 c h^2) |x - x_tilde|_M^2, one element a vertex.
#include <numeric>

#include "core/energy/vertex_loads.hpp"
#include "core/math/parallel.hpp"
#include "core/terms/registry.hpp"

namespace bb {
namespace {

class Inertia final : public Term {
 public:
  explicit Inertia(const Scene& scene) : mass_(scene.mass), vertices_(mass_.size()), weight_(mass_.size()) {
    std::iota(vertices_.begin(), vertices_.end(), 0);
    TermFamily& family = families_.emplace_back();
    family.stencils = {1, vertices_};
    family.local.resize(vertices_.size(), 1);
    family.trial_energy.resize(vertices_.size());
  }

  std::string_view name() const override { return "inertia"; }
  TermGroup group() const override { return TermGroup::load; }
  Phase phase() const override { return Phase::assembly; }
  bool on_vertices() const override { return true; }

  void change_frame(const StepFrame& frame) override {
    x_tilde_ = frame.x_tilde;
    std::vector<double>& hess = families_[0].local.hess;
    for (std::size_t i = 0; i < weight_.size(); ++i) {
      weight_[i] = inertia_weight(mass_[i], frame.c, frame.dt);
      for (std::size_t k = 0; k < 3; ++k) hess[9 * i + 4 * k] = weight_[i];
    }
  }

  void linearise(const PositionsView& x, const TermContext&) override {
    LocalTerms& local = families_[0].local;
    fill_energies(x, local.energy);
    parallel_items(weight_.size(), block_items,
                   [&](std::size_t i) { Vec3d::Map(&local.grad[3 * i]) = weight_[i] * off_target(x, i); });
  }
  void evaluate(const PositionsView& x) override { fill_energies(x, families_[0].trial_energy); }

  void change(const PositionsView& x0, const PositionsView& x1, EnergyParts& out) const override {
    const std::size_t start = out.size();
    out.resize(start + weight_.size());
    parallel_items(weight_.size(), block_items, [&](std::size_t i) {
      const auto v = static_cast<Eigen::Index>(i);
      const Vec3d step = x1.col(v) - x0.col(v);
      const auto part = inertia_change(weight_[i], off_target(x0, i), off_target(x1, i), step);
      out[start + i] = {part.change, part.magnitude};
    });
  }

 private:
  Vec3d off_target(const PositionsView& x, std::size_t i) const {
    const auto v = static_cast<Eigen::Index>(i);
    return x.col(v) - x_tilde_.col(v);
  }
  void fill_energies(const PositionsView& x, std::vector<double>& energy) const {
    parallel_items(weight_.size(), block_items,
                   [&](std::size_t i) { energy[i] = inertia_value(weight_[i], off_target(x, i)); });
  }

  const std::vector<double>& mass_;  // [n] kg, 0 for prescribed vertices
  std::vector<int> vertices_;
  std::vector<double> weight_;  // [n] m_i/(c h^2), N/m
  Positions x_tilde_;
};

}  // namespace

PlanItem needs_inertia(const TermNeeds& needs) {
  return plan_item(!needs.scene.mass.empty(), "vertices have mass", "no vertex");
}

void make_inertia(const TermInputs& inputs, TermList& terms) {
  terms.add(std::make_unique<Inertia>(inputs.scene));
}

}  // namespace bb
