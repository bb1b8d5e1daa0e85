// Soft pins on an executor: places and stiffnesses of a step come from the host, as those of pins do.
#include "core/terms/pull.hpp"

#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/vertex_quadratic.hpp"

namespace bb::resident {
namespace {

class PullTerm final : public QuadraticTerm {
 public:
  explicit PullTerm(const ResidentInputs& inputs)
      : QuadraticTerm(inputs, "pull", pulled_vertices(inputs.scene)), scene_(inputs.scene) {}

  void change_frame(const ResidentFrame& frame) override {
    const std::vector<PulledTo> pulls = pulls_of_step(scene_, frame.t_end, frame.middle());
    const std::size_t n = pulls.size();
    std::vector<double> place(3 * n), matrix(9 * n);
    for (std::size_t e = 0; e < n; ++e) {
      for (int c = 0; c < 3; ++c) {
        place[static_cast<std::size_t>(c) * n + e] = pulls[e].place[c];
        matrix[static_cast<std::size_t>(4 * c) * n + e] = pulls[e].stiffness;
      }
    }
    place_.upload(place);
    matrix_.upload(matrix);
  }

 private:
  const Scene& scene_;
};

}  // namespace

void make_resident_pull(const ResidentInputs& inputs, ResidentTermList& terms) {
  terms.add(std::make_unique<PullTerm>(inputs));
}

}  // namespace bb::resident
