// contact_stages PROBLEM THREADS: runs one stage of the contact pipeline for each line that it reads and
// answers it with one line of JSON, {"stage", "s", "items", "value"}: wall time, what was handled, a number
// that the toolkit's answer is compared with. ./bench study compare-toolkit runs it and the IPC Toolkit in turn.
// The formulation is ipc2020: log on the squared gap, kappa = 1 N/m.
#include <oneapi/tbb/global_control.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <numeric>

#include "barriers/shapes/registry.hpp"
#include "core/contact/contact_terms.hpp"
#include "core/linear/block_system.hpp"
#include "experiments/microbenchmarks/contact_problem.hpp"

namespace {

using namespace bb;

/// What a stage handled, and a number to compare.
struct Answer {
  std::size_t items;
  double value;
};

class Pipeline {
 public:
  explicit Pipeline(const ContactProblem& problem)
      : x0_(problem.scene.x0),
        x1_(problem.x1),
        contacts_(problem.scene, problem.options),
        blocks_(problem.scene.n_vertices(), std::vector<std::uint8_t>(3 * at(problem.scene.n_vertices()), 0)),
        gradient_(Positions::Zero(3, problem.scene.n_vertices())) {
    blocks_.set_elements({});
  }

  Answer candidates_standing() {
    contacts_.update_candidates(x0_, x0_);
    return {n_candidates(), 0};
  }
  /// Of the state at the start, from the candidates of the last stage that made some.
  Answer rows() {
    const double gap = contacts_.find_rows(x0_, rows_, mollified_);
    return {rows_.size() + mollified_.size(), gap};
  }
  Answer candidates_motion() {
    contacts_.update_candidates(x0_, x1_);
    return {n_candidates(), 0};
  }
  Answer step_bound() {
    const StepBound bound = contacts_.step_bound(x0_, x1_);
    return {static_cast<std::size_t>(bound.queries), bound.alpha};
  }
  /// Both of the last two for a motion of which no more is needed than what its bound leaves; after rows().
  Answer motion_to_bound() {
    contacts_.update_candidates_to_bound(x0_, x1_);
    const StepBound bound = contacts_.step_bound(x0_, x1_);
    return {n_candidates(), bound.alpha};
  }
  /// The value is the Euclidean norm of the gradient.
  Answer gradient_and_hessian() {
    evaluate();
    contact_terms(rows_, x0_, HessianMode::projected_full, Projection::psd, grad_[0], hess_[0]);
    mollified_terms(mollified_, x0_, Projection::psd, grad_[1], hess_[1]);
    blocks_.set_contacts({{4, rows_.vertex}, {4, mollified_.free_vertex}});
    blocks_.clear();
    gradient_.setZero();
    for (const std::size_t family : {0, 1}) {
      blocks_.add_contacts(family, hess_[family]);
      blocks_.gather_contacts(family, grad_[family], gradient_);
    }
    return {rows_.size() + mollified_.size(), gradient_.norm()};
  }
  Answer energies() {
    evaluate();
    contact_energies(rows_, energy_[0]);
    mollified_energies(mollified_, x0_, energy_[1]);
    double sum = 0;
    for (const auto& energies : energy_) sum = std::accumulate(energies.begin(), energies.end(), sum);
    return {rows_.size() + mollified_.size(), sum};
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  std::size_t n_candidates() const {
    const ContactSystem::Counts n = contacts_.candidate_counts();
    return n.point_triangle + n.edge_edge + n.point_point + n.point_edge;
  }
  void evaluate() {
    const auto fill = [this](auto& t) {
      barrier_.eval(t.size(), t.d.data(), t.d_hat.data(), t.b.data(), t.db.data(), t.d2b.data());
      std::fill(t.kappa.begin(), t.kappa.end(), 1.0);
    };
    fill(rows_);
    fill(mollified_);
  }

  const BarrierFunction barrier_{require_shape("log"), Argument::squared_gap};
  const Positions &x0_, &x1_;
  ContactSystem contacts_;
  BlockSystem blocks_;
  ContactTable rows_;
  MollifiedTable mollified_;
  std::vector<double> energy_[2], grad_[2], hess_[2];
  Positions gradient_;
};

using Stage = Answer (Pipeline::*)();
const std::map<std::string, Stage> stages = {
    {"candidates_standing", &Pipeline::candidates_standing},
    {"candidates_motion", &Pipeline::candidates_motion},
    {"rows", &Pipeline::rows},
    {"step_bound", &Pipeline::step_bound},
    {"motion_to_bound", &Pipeline::motion_to_bound},
    {"gradient_and_hessian", &Pipeline::gradient_and_hessian},
    {"energies", &Pipeline::energies},
};

}  // namespace

int main(int argc, char** argv) {
  const int n_threads = argc == 3 ? std::atoi(argv[2]) : 0;
  if (n_threads < 1) {
    std::fprintf(stderr, "usage: contact_stages PROBLEM THREADS\n");
    return 2;
  }
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, std::size_t(n_threads));
  const ContactProblem problem = read_contact_problem(argv[1]);
  if (!problem.valid()) {
    std::fprintf(stderr, "contact_stages: %s is no problem file\n", argv[1]);
    return 2;
  }
  Pipeline pipeline(problem);
  for (std::string name; std::getline(std::cin, name);) {
    const auto stage = stages.find(name);
    if (stage == stages.end()) {
      std::fprintf(stderr, "contact_stages: no stage '%s'\n", name.c_str());
      return 2;
    }
    const auto start = std::chrono::steady_clock::now();
    const Answer answer = (pipeline.*(stage->second))();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("{\"stage\": \"%s\", \"s\": %.9g, \"items\": %zu, \"value\": %.17g}\n", name.c_str(),
                seconds.count(), answer.items, answer.value);
    std::fflush(stdout);
  }
  return 0;
}
