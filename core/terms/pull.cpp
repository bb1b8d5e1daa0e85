// Soft pins: k/2 |x - p(t)|^2, p where the motion of a pin takes its vertex by the end of the step, k its stiffness then.
#include "core/terms/pull.hpp"

#include <fmt/format.h>

#include "core/terms/registry.hpp"
#include "core/terms/vertex_quadratic.hpp"

namespace bb {

std::vector<int> pulled_vertices(const Scene& scene) {
  std::vector<int> out;
  for (const Pull& pull : scene.pulls) out.insert(out.end(), pull.vertices.begin(), pull.vertices.end());
  return out;
}

namespace {

/// Of the stiffness in a step.
double factor_of(const Pull& pull, double t_end, double middle) {
  if (!pull.span.holds(middle)) return 0;
  return pull.factors.empty() ? 1 : value_at(pull.factors, t_end);
}

}  // namespace

std::vector<PulledTo> pulls_of_step(const Scene& scene, double t_end, double middle) {
  std::vector<PulledTo> out;
  for (const Pull& pull : scene.pulls) {
    const RigidMotion& motion = scene.motions[static_cast<std::size_t>(pull.motion)];
    const double stiffness = pull.stiffness * factor_of(pull, t_end, middle);
    for (const int v : pull.vertices) out.push_back({motion(scene.x0.col(v), t_end), stiffness});
  }
  return out;
}

std::vector<bool> acting_pulls(const Scene& scene, double middle) {
  std::vector<bool> out;
  for (const Pull& pull : scene.pulls) out.push_back(pull.span.holds(middle));
  return out;
}

namespace {

class PullTerm final : public VertexQuadratic {
 public:
  explicit PullTerm(const Scene& scene) : VertexQuadratic(pulled_vertices(scene)), scene_(scene) {}
  std::string_view name() const override { return "pull"; }

  void change_frame(const StepFrame& frame) override {
    std::size_t e = 0;
    for (const PulledTo& to : pulls_of_step(scene_, frame.t_end, frame.middle())) {
      set(e++, to.place, to.stiffness * Mat3d::Identity());
    }
  }

 private:
  const Scene& scene_;
};

}  // namespace

PlanItem needs_pull(const TermNeeds& needs) {
  const std::size_t n = pulled_vertices(needs.scene).size();
  return plan_item(n > 0, fmt::format("{} pulled vertices", n), "no pin pulls");
}

void make_pull(const TermInputs& inputs, TermList& terms) {
  terms.add(std::make_unique<PullTerm>(inputs.scene));
}

}  // namespace bb
