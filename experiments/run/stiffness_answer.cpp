#include "experiments/run/stiffness_answer.hpp"

#include <algorithm>
#include <cmath>

#include "core/linear/solvers/linear_solvers.hpp"
#include "core/terms/contact.hpp"

namespace bb {
namespace {

// The gradient of the terms of these groups at the iterate, N.
Positions gradient_of(const Diagnosis& system, TermSet set) {
  Positions out = Positions::Zero(3, system.x().cols());
  for (const auto& term : system.terms()) {
    if (!set.has(term->group())) continue;
    for (const TermFamily& family : term->families()) {
      const auto width = static_cast<std::size_t>(family.stencils.width);
      for (std::size_t i = 0; i < family.stencils.size() * width; ++i) {
        const int v = family.stencils.vertices[i];
        if (v < 0) continue;
        for (std::size_t k = 0; k < 3; ++k)
          out(static_cast<Eigen::Index>(k), v) += family.local.grad[3 * i + k];
      }
    }
  }
  return out;
}

ReducedSystem with_inertia(ReducedSystem matrix, const std::vector<double>& mass, double factor) {
  for (std::size_t block = 0; block + 1 < matrix.block_start.size(); ++block) {
    const double m = mass[static_cast<std::size_t>(matrix.block_vertex[block])];
    for (int i = matrix.block_start[block]; i < matrix.block_start[block + 1]; ++i)
      matrix.lower.coeffRef(i, i) += factor * m;
  }
  return matrix;
}

// How the quasi-static state moves with the factor s; false where no factor was found even with all inertia.
bool response(Diagnosis& system, const Positions& push, double dt, Positions& dx) {
  const TermSet set = TermSet(TermGroup::elastic) | TermGroup::limit | TermGroup::contact;
  const ReducedSystem matrix = system.clamped(set);
  VecXd rhs, solution;
  system.blocks().restrict_vector(push, rhs);
  const std::unique_ptr<LinearSolver> solver = make_linear_solver({});
  for (const double share : {1e-6, 1e-4, 1e-2, 1.0}) {
    const ReducedSystem held = with_inertia(matrix, system.scene().mass, share / (dt * dt));
    if (solver->solve(held, rhs, solution).status != LinearStatus::ok) continue;
    dx.setZero(3, push.cols());
    system.blocks().expand_vector(solution, dx);
    return true;
  }
  return false;
}

void fill_contacts(const ContactTable& rows, const Positions& dx, std::vector<double>& out) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (!(rows.db[r] < 0)) continue;
    const Eigen::Map<const Vec3d> normal(&rows.normal[3 * r]);
    double opening = 0;
    for (std::size_t k = 0; k < 4 && rows.vertex[4 * r + k] >= 0; ++k)
      opening += rows.weight[4 * r + k] * normal.dot(dx.col(rows.vertex[4 * r + k]));
    out[r] = 1 + rows.d2b[r] / rows.db[r] * opening;
  }
}

// The gap of an element changes by a difference over a millionth of the side of the smallest element.
void fill_elements(LimitFamily& limit, const BarrierFunction& barrier, const std::vector<double>& width,
                   const Positions& x, const Positions& dx, std::vector<double>& out) {
  const double largest = dx.cwiseAbs().maxCoeff();
  double area = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < width.size(); ++e) area = std::min(area, limit.measure_of(e));
  const double t = largest > 0 ? 1e-6 * std::sqrt(area) / largest : 1;
  const Positions back = x - t * dx, forth = x + t * dx;
  const std::vector<double> y = limit.smallest_gaps(x.data()), less = limit.smallest_gaps(back.data()),
                            more = limit.smallest_gaps(forth.data());
  for (std::size_t e = 0; e < width.size(); ++e) {
    if (!(y[e] < width[e])) continue;
    const auto b = barrier.eval(y[e], width[e]);
    if (b.db < 0) out[e] = 1 + b.d2b / b.db * (more[e] - less[e]) / (2 * t);
  }
}

}  // namespace

void AnswerSums::add_contact(const ContactTable& rows, std::size_t row, double force, double answer) {
  for (std::size_t k = 4 * row; k < 4 * row + 4 && rows.vertex[k] >= 0; ++k) {
    const double share = std::abs(rows.weight[k]) * force;
    if (share > 0) contact_[static_cast<std::size_t>(rows.vertex[k])].add(share, answer);
  }
}

double AnswerSums::of_contact(const ContactTable& rows, std::size_t row) const {
  double sum = 0, weights = 0;
  for (std::size_t k = 4 * row; k < 4 * row + 4 && rows.vertex[k] >= 0; ++k) {
    sum += std::abs(rows.weight[k]) * contact_[static_cast<std::size_t>(rows.vertex[k])].mean();
    weights += std::abs(rows.weight[k]);
  }
  return weights > 0 ? sum / weights : 0;
}

StiffnessAnswers answers_to_stiffness(Diagnosis& system, LimitFamily* limit,
                                      const BarrierFunction& limit_barrier, double dt) {
  StiffnessAnswers out;
  const ContactTable& rows = contact_state(system.terms()).rows;
  out.contact.assign(rows.size(), 0.0);
  if (limit) out.limit.assign(static_cast<std::size_t>(limit->size()), 0.0);
  const Positions push = -gradient_of(system, TermSet(TermGroup::limit) | TermGroup::contact);
  if (push.isZero(0)) return out;
  Positions dx;
  out.known = response(system, push, dt, dx);
  if (!out.known) return out;
  fill_contacts(rows, dx, out.contact);
  if (limit) fill_elements(*limit, limit_barrier, system.scene().limit.width, system.x(), dx, out.limit);
  return out;
}

}  // namespace bb
