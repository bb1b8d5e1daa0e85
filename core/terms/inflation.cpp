// A pressure from within closed surfaces: -p V. Volumes are taken from the centre of the body at the start of the step, on which their
// sum does not depend.
#include "core/energy/inflation.hpp"

#include <fmt/format.h>

#include "core/energy/element_loop.hpp"
#include "core/terms/registry.hpp"

namespace bb {
namespace {

class InflationTerm final : public Term {
 public:
  InflationTerm(const Scene& scene, Precision precision) : scene_(scene), precision_(precision) {
    for (const auto& t : scene.inflation.triangles) vertices_.insert(vertices_.end(), t.begin(), t.end());
    TermFamily& family = families_.emplace_back();
    family.stencils = {3, vertices_};
    family.local.resize(size_of(), 3);
    family.trial_energy.resize(size_of());
  }
  std::string_view name() const override { return "inflation"; }
  TermGroup group() const override { return TermGroup::load; }
  Phase phase() const override { return Phase::assembly; }

  void begin_step(const StepFrame& frame, PhaseClock&) override {
    change_frame(frame);
    centre_.resize(3, static_cast<Eigen::Index>(scene_.bodies.size()));
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      const Body& body = scene_.bodies[b];
      centre_.col(static_cast<Eigen::Index>(b)) =
          frame.x_n.middleCols(body.first_vertex, body.n_vertices).rowwise().mean();
    }
  }
  void change_frame(const StepFrame& frame) override {
    const Inflation& of = scene_.inflation;
    pressure_ = of.pressure;
    std::vector<double> now;
    for (const auto& keys : of.key_lists) now.push_back(value_at(keys, frame.t_end));
    for (std::size_t e = 0; e < size_of() && !now.empty(); ++e) {
      if (of.keys[e] >= 0) pressure_[e] *= now[static_cast<std::size_t>(of.keys[e])];
    }
  }
  void linearise(const PositionsView& x, const TermContext& context) override {
    derivatives(x, context.projection, families_[0].local);
  }
  void clamp(const PositionsView& x) override { derivatives(x, Projection::psd, families_[0].clamped); }
  void evaluate(const PositionsView& x) override {
    const auto value = [&]<class T>(std::size_t e) {
      Vec<T, 3> p[3];
      take(x, e, p);
      return -pressure<T>(e) * volume_below<T>(p[0], p[1], p[2]);
    };
    store_energies(size_of(), precision_, value, families_[0].trial_energy.data());
  }

 private:
  std::size_t size_of() const { return scene_.inflation.triangles.size(); }
  template <class T>
  T pressure(std::size_t e) const {
    return static_cast<T>(pressure_[e]);
  }
  /// Corners of triangle e off the centre of its body.
  template <class T>
  void take(const PositionsView& x, std::size_t e, Vec<T, 3> (&out)[3]) const {
    const int body = scene_.body[static_cast<std::size_t>(vertices_[3 * e])];
    for (std::size_t k = 0; k < 3; ++k) {
      out[k] = (x.col(vertices_[3 * e + k]) - centre_.col(body)).template cast<T>();
    }
  }
  void derivatives(const PositionsView& x, Projection projection, LocalTerms& out) const {
    out.resize(size_of(), 3);
    const auto terms = [&]<class T>(std::size_t e) {
      Vec<T, 3> p[3];
      take(x, e, p);
      return inflation_terms<T>(p, pressure<T>(e), projection);
    };
    store_elements(size_of(), precision_, terms, out);
  }

  const Scene& scene_;
  Precision precision_;
  std::vector<int> vertices_;     // [3 n]
  Positions centre_;              // [3 x bodies] m
  std::vector<double> pressure_;  // [n] Pa, of the step
};

}  // namespace

PlanItem needs_inflation(const TermNeeds& needs) {
  const std::size_t n = needs.scene.inflation.triangles.size();
  return plan_item(n > 0, fmt::format("{} triangles under pressure", n), "no body is under pressure");
}

void make_inflation(const TermInputs& inputs, TermList& terms) {
  terms.add(std::make_unique<InflationTerm>(inputs.scene, inputs.options.precision));
}

}  // namespace bb
