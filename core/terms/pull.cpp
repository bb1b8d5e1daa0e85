// Soft pins: k/2 |x - p(t)|^2, p where the motion of a pin takes its vertex by the end of the step, k its stiffness then.
#include <fmt/format.h>

#include "core/terms/registry.hpp"
#include "core/terms/vertex_quadratic.hpp"

namespace bb {
namespace {

std::vector<int> pulled_vertices(const Scene& scene) {
  std::vector<int> out;
  for (const Pull& pull : scene.pulls) out.insert(out.end(), pull.vertices.begin(), pull.vertices.end());
  return out;
}

class PullTerm final : public VertexQuadratic {
 public:
  explicit PullTerm(const Scene& scene) : VertexQuadratic(pulled_vertices(scene)), scene_(scene) {}
  std::string_view name() const override { return "pull"; }

  void change_frame(const StepFrame& frame) override {
    std::size_t e = 0;
    for (const Pull& pull : scene_.pulls) {
      const RigidMotion& motion = scene_.motions[static_cast<std::size_t>(pull.motion)];
      const double factor = pull.factors.empty() ? 1 : value_at(pull.factors, frame.t_end);
      const Mat3d stiffness = pull.stiffness * factor * Mat3d::Identity();
      for (const int v : pull.vertices) set(e++, motion(scene_.x0.col(v), frame.t_end), stiffness);
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
