// contact_probe IN OUT: rows, potential, gradient, projected Hessian and collision-free step of a surface
// whose vertices are all free, for comparison with an independent code (test_ipctk.py, which also documents
// the layout of both files). The formulation is ipc2020: log on the squared gap, kappa = 1 N/m.
#include <cstdint>
#include <cstdio>
#include <fstream>

#include "barriers/shapes/registry.hpp"
#include "core/contact/contact_terms.hpp"
#include "core/math/lower_blocks.hpp"
#include "experiments/microbenchmarks/contact_problem.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace {

using namespace bb;

template <class T>
void write(std::ofstream& out, const T* values, std::size_t n) {
  out.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(n * sizeof(T)));
}

template <class Table>
void evaluate(Table& t, const BarrierFunction& barrier) {
  barrier.eval(t.size(), t.d.data(), t.d_hat.data(), t.b.data(), t.db.data(), t.d2b.data());
  std::fill(t.kappa.begin(), t.kappa.end(), 1.0);
}

struct Entry {
  std::int32_t row, column;
  double value;
};

void scatter(const std::vector<int>& vertex, const std::vector<double>& grad, const std::vector<double>& hess,
             Positions& gradient, std::vector<Entry>& entries) {
  for (std::size_t row = 0; row < vertex.size() / 4; ++row) {
    const int* v = &vertex[4 * row];
    const Eigen::MatrixXd h = test::from_lower_blocks(&hess[n_lower_numbers(4) * row], 4);
    for (int i = 0; i < 4; ++i) {
      if (v[i] < 0) continue;
      gradient.col(v[i]) += Vec3d::Map(&grad[12 * row + 3 * static_cast<std::size_t>(i)]);
      for (int j = 0; j < 4; ++j) {
        for (int a = 0; v[j] >= 0 && a < 3; ++a) {
          for (int b = 0; b < 3; ++b)
            entries.push_back({3 * v[i] + a, 3 * v[j] + b, h(3 * i + a, 3 * j + b)});
        }
      }
    }
  }
}

/// [n_vertices] parts of the motion by a rule that bounds each vertex, with the toolkit's gamma.
void write_parts(std::ofstream& out, const ContactProblem& p, StepBoundRule rule) {
  ContactOptions options = p.options;
  options.step_bound = rule;
  ContactSystem contacts(p.scene, options);
  contacts.update_candidates_of_each(p.scene.x0, p.x1);
  contacts.vertex_bounds(p.scene.x0, p.x1);
  write(out, contacts.vertex_parts().data(), contacts.vertex_parts().size());
}

/// Potential and gradient with kappa = 1 N/m^3 and the shares of a weighting.
double write_weighted(std::ofstream& out, const ContactProblem& p, const BarrierFunction& barrier,
                      ContactWeighting weighting) {
  ContactOptions options = p.options;
  options.weighting = weighting;
  ContactSystem contacts(p.scene, options);
  ContactTable rows;
  MollifiedTable mollified;
  contacts.update_candidates(p.scene.x0, p.scene.x0);
  contacts.find_rows(p.scene.x0, rows, mollified);
  evaluate(rows, barrier);
  evaluate(mollified, barrier);
  rows.kappa = rows.share;
  mollified.kappa = mollified.share;
  double potential = 0;
  std::vector<double> energy, grad, hess;
  std::vector<Entry> unread;
  Positions gradient = Positions::Zero(3, p.scene.n_vertices());
  contact_energies(rows, energy);
  for (double e : energy) potential += e;
  mollified_energies(mollified, p.scene.x0, energy);
  for (double e : energy) potential += e;
  contact_terms(rows, p.scene.x0, HessianMode::projected_full, Projection::psd, grad, hess);
  scatter(rows.vertex, grad, hess, gradient, unread);
  mollified_terms(mollified, p.scene.x0, Projection::psd, grad, hess);
  scatter(mollified.free_vertex, grad, hess, gradient, unread);
  write(out, gradient.data(), static_cast<std::size_t>(gradient.size()));
  return potential;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const ContactProblem p = read_contact_problem(argv[1]);
  if (!p.valid()) return 2;
  ContactSystem contacts(p.scene, p.options);
  contacts.update_candidates(p.scene.x0, p.x1);
  const StepBound bound = contacts.step_bound(p.scene.x0, p.x1);

  ContactTable rows;
  MollifiedTable mollified;
  contacts.update_candidates(p.scene.x0, p.scene.x0);
  contacts.find_rows(p.scene.x0, rows, mollified);
  const BarrierFunction barrier{require_shape("log"), Argument::squared_gap};
  evaluate(rows, barrier);
  evaluate(mollified, barrier);

  double potential = 0;
  std::vector<double> energy, grad, hess;
  contact_energies(rows, energy);
  for (double e : energy) potential += e;
  mollified_energies(mollified, p.scene.x0, energy);
  for (double e : energy) potential += e;
  Positions gradient = Positions::Zero(3, p.scene.n_vertices());
  std::vector<Entry> entries;
  contact_terms(rows, p.scene.x0, HessianMode::projected_full, Projection::psd, grad, hess);
  scatter(rows.vertex, grad, hess, gradient, entries);
  mollified_terms(mollified, p.scene.x0, Projection::psd, grad, hess);
  scatter(mollified.free_vertex, grad, hess, gradient, entries);

  std::ofstream out(argv[2], std::ios::binary);
  write(out, rows.stencil.data(), rows.stencil.size());
  write(out, rows.d.data(), rows.size());
  write(out, mollified.stencil.data(), mollified.stencil.size());
  write(out, mollified.d.data(), mollified.size());
  write(out, gradient.data(), static_cast<std::size_t>(gradient.size()));
  for (const Entry& e : entries) {
    write(out, &e.row, 1);
    write(out, &e.column, 1);
    write(out, &e.value, 1);
  }
  for (const StepBoundRule rule : {StepBoundRule::planar_truncation, StepBoundRule::per_vertex})
    write_parts(out, p, rule);
  const double weighted = write_weighted(out, p, barrier, ContactWeighting::area);
  const double corrected = write_weighted(out, p, barrier, ContactWeighting::area_corrected);
  std::printf(
      "{\"rows\": %zu, \"mollified\": %zu, \"entries\": %zu, \"potential\": %.17g, "
      "\"weighted\": %.17g, \"corrected\": %.17g, \"alpha\": %.17g, \"queries\": %lld, \"probes\": %lld, "
      "\"capped\": %lld, "
      "\"zero\": %lld}\n",
      rows.size(), mollified.size(), entries.size(), potential, weighted, corrected, bound.alpha,
      bound.queries, bound.probes, bound.capped, bound.zero);
  return out ? 0 : 1;
}
