// Resident elements of a scene with their vectors, as tests ask them.
#pragma once

#include "core/exec/host_executor.hpp"
#include "core/resident/elements/resident_elements.hpp"
#include "tests/resident/cpu_elements.hpp"

namespace bb::test {

inline std::span<const double> numbers_of(const Positions& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

struct OnExecutor {
  exec::Buffer<double> x_n, x_tilde, x, trial, dx, g;
  resident::ResidentElements elements;
  resident::ResidentSum sum;

  OnExecutor(exec::Executor& executor, const Scene& scene, const TermOptions& options, const StepFrame& frame,
             exec::Index piece = resident::ResidentElements::default_piece)
      : x_n(executor, "start"),
        x_tilde(executor, "prediction"),
        x(executor, "iterate"),
        trial(executor, "trial"),
        dx(executor, "direction"),
        g(executor, "gradient", scene.rest.size()),
        elements(executor, scene, options, piece),
        sum(executor) {
    x_n.upload(numbers_of(frame.x_n));
    x_tilde.upload(numbers_of(frame.x_tilde));
    elements.begin_step(resident_frame(frame));
  }
  resident::ResidentFrame resident_frame(const StepFrame& frame) const {
    return {x_n.data(), x_tilde.data(), frame.dt, frame.c, frame.load_factor};
  }
  /// kappa of the limit, gradient and energies at x. Returns how far kappa has moved.
  double linearise(const Positions& at) {
    x.upload(numbers_of(at));
    elements.clear_matrix();
    elements.add_matrix(TermGroup::elastic, x.data(), resident::clamped_hessian);
    const double moved = elements.refresh_limit(x.data());
    elements.linearise(x.data(), g.data());
    return moved;
  }
  void fill(TermSet set, const resident::HessianRequest& request) {
    elements.clear_matrix();
    elements.add_matrix(set, x.data(), [&](std::string_view) { return request; });
  }
  resident::Compensated energy(TermSet set) {
    sum.clear();
    elements.add_energy(set, x.data(), sum);
    return sum.get();
  }
  bool evaluate(const Positions& at) {
    trial.upload(numbers_of(at));
    if (!elements.admits(trial.data())) return false;
    elements.evaluate(trial.data());
    return true;
  }
  resident::Compensated change() {
    sum.clear();
    elements.add_change(x.data(), trial.data(), sum);
    return sum.get();
  }
  double bound(const Positions& direction, double park) {
    dx.upload(numbers_of(direction));
    return elements.bound(x.data(), dx.data(), park);
  }
  Positions gradient() const {
    Positions out(3, elements.n_vertices());
    g.download({out.data(), static_cast<std::size_t>(out.size())});
    return out;
  }
  /// All numbers of all blocks, in their order.
  std::vector<double> matrix() const {
    const resident::MatrixPart part = elements.matrix();
    std::vector<double> out;
    for (exec::Index j = 0; j < elements.n_blocks(); ++j) {
      for (int c = 0; c < 9; ++c) out.push_back(part.value[resident::value_index(j, c)]);
    }
    return out;
  }
};

/// The five orders of a host executor.
inline std::vector<std::unique_ptr<exec::HostExecutor>> all_orders() {
  std::vector<std::unique_ptr<exec::HostExecutor>> out;
  for (const exec::Order order :
       {exec::Order::threads, exec::Order::forward, exec::Order::reverse, exec::Order::shuffled}) {
    out.push_back(std::make_unique<exec::HostExecutor>(order, 3));
  }
  out.push_back(std::make_unique<exec::HostExecutor>(exec::Order::shuffled, 17));
  return out;
}

}  // namespace bb::test
