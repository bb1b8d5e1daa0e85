// Gradient, matrix, energy and given motion of the rows of a scene, on the CPU path and on an executor.
#pragma once

#include <gtest/gtest.h>

#include "barriers/shapes/registry.hpp"
#include "core/contact/executor/contact_sums.hpp"
#include "core/contact/executor/executor_barrier.hpp"
#include "tests/executor/contact_on_executor.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::test {

using exec::AssemblyOptions;
using exec::ContactAssembly;
using exec::ExecutorBarrier;
using exec::HessianChoice;
using exec::MatrixPart;
using exec::RowSums;
using Matrix = Eigen::MatrixXd;

inline constexpr double kappa = 350;

inline BarrierFunction cubic() { return {require_shape("cubic"), Argument::gap}; }

/// What the CPU path adds up.
struct Reference {
  VecXd gradient;
  Matrix exact, projected;
  double energy = 0;
  Positions force;
  std::size_t n_mollified = 0, n_curved = 0;
};

inline void scatter(const std::vector<int>& vertex, const std::vector<double>& grad,
                    const std::vector<double>& hess, VecXd* gradient, Matrix& matrix) {
  for (std::size_t r = 0; r < grad.size() / 12; ++r) {
    const Matrix h = from_lower_blocks(&hess[n_lower_numbers(4) * r], 4);
    for (int i = 0; i < 4; ++i) {
      const int vi = vertex[4 * r + at(i)];
      if (vi < 0) continue;
      if (gradient) gradient->segment<3>(3 * vi) += Vec3d::Map(&grad[12 * r + 3 * at(i)]);
      for (int j = 0; j < 4; ++j) {
        const int vj = vertex[4 * r + at(j)];
        if (vj >= 0) matrix.block<3, 3>(3 * vi, 3 * vj) += h.block<3, 3>(3 * i, 3 * j);
      }
    }
  }
}

template <class Table>
void evaluate_cubic(Table& t) {
  const BarrierFunction barrier = cubic();
  std::fill(t.kappa.begin(), t.kappa.end(), kappa);
  barrier.eval(t.size(), t.d.data(), t.d_hat.data(), t.b.data(), t.db.data(), t.d2b.data());
}

inline Reference reference_of(const Scene& scene, const Positions& x, const Positions& motion,
                              HessianMode mode, Projection projection) {
  ContactSystem contacts(scene, {});
  Rows rows = rows_at(contacts, x);
  evaluate_cubic(rows.table);
  evaluate_cubic(rows.mollified);
  Reference out{VecXd::Zero(x.size()), Matrix::Zero(x.size(), x.size()), Matrix::Zero(x.size(), x.size()), 0,
                Positions::Zero(3, x.cols())};
  std::vector<double> grad, hess;
  for (const Projection p : {Projection::none, projection}) {
    Matrix& to = p == projection ? out.projected : out.exact;
    VecXd* const gradient = &to == &out.projected ? &out.gradient : nullptr;
    to.setZero();
    out.gradient.setZero();
    contact_terms(rows.table, x, mode, p, grad, hess);
    scatter(rows.table.vertex, grad, hess, gradient, to);
    mollified_terms(rows.mollified, x, p, grad, hess);
    scatter(rows.mollified.free_vertex, grad, hess, gradient, to);
    if (projection == Projection::none) out.exact = out.projected;
  }
  std::vector<double> energy;
  contact_energies(rows.table, energy);
  for (const double e : energy) out.energy += e;
  mollified_energies(rows.mollified, x, energy);
  for (const double e : energy) out.energy += e;
  add_given_motion(rows.table, motion, out.force);
  add_given_motion(rows.mollified, x, motion, out.force);
  out.n_mollified = rows.mollified.size();
  for (std::size_t r = 0; r < rows.table.size(); ++r) {
    const ContactKind k = rows.table.kind[r];
    out.n_curved += rows.table.db[r] != 0 && k != ContactKind::point_point && k != ContactKind::obstacle;
  }
  return out;
}

/// Of every row the clamped Hessian where a free vertex of it has a force of at least the threshold, else the exact one. clamped:
/// how many rows have the first.
inline Matrix partly_clamped(const Scene& scene, const Positions& x, HessianMode mode,
                             const std::vector<double>& force, double threshold, std::size_t& clamped) {
  ContactSystem contacts(scene, {});
  Rows rows = rows_at(contacts, x);
  evaluate_cubic(rows.table);
  evaluate_cubic(rows.mollified);
  Matrix out = Matrix::Zero(x.size(), x.size());
  const auto add = [&](const std::vector<int>& vertex, const auto& terms) {
    std::vector<double> grad, hess, psd;
    terms(Projection::none, grad, hess);
    terms(Projection::psd, grad, psd);
    const std::size_t stride = n_lower_numbers(4);
    for (std::size_t r = 0; r < hess.size() / stride; ++r) {
      const bool large = std::any_of(&vertex[4 * r], &vertex[4 * r] + 4,
                                     [&](int v) { return v >= 0 && force[at(v)] >= threshold; });
      if (large) std::copy_n(&psd[stride * r], stride, &hess[stride * r]);
      clamped += large;
    }
    scatter(vertex, grad, hess, nullptr, out);
  };
  add(rows.table.vertex,
      [&](Projection p, auto& grad, auto& hess) { contact_terms(rows.table, x, mode, p, grad, hess); });
  add(rows.mollified.free_vertex,
      [&](Projection p, auto& grad, auto& hess) { mollified_terms(rows.mollified, x, p, grad, hess); });
  return out;
}

inline Positions motion_of_given(const Scene& scene) {
  Positions motion = Positions::Zero(3, scene.n_vertices());
  for (const Pin& pin : scene.pins) motion.col(pin.vertex) = 1e-3 * Vec3d(1, -2, 0.5 * pin.vertex);
  return motion;
}

/// All that is assembled at x.
struct Assembled {
  VecXd gradient;
  Matrix matrix;
  Positions force;
  double energy = 0;
  std::string bytes;
  Index n_blocks = 0, n_rows = 0;
};

inline Matrix dense(const MatrixPart& part, int n) {
  Matrix out = Matrix::Zero(3 * n, 3 * n);
  for (int i = 0; i < n; ++i) {
    for (Index j = part.row_begin[i]; j < part.row_begin[i + 1]; ++j) {
      if (j > part.row_begin[i]) {
        EXPECT_LT(part.column[j - 1], part.column[j]);
      }
      for (int c = 0; c < 9; ++c) {
        out(3 * i + c % 3, 3 * part.column[j] + c / 3) = part.value[exec::value_index(j, c)];
      }
    }
  }
  return out;
}

inline Assembled assemble(exec::Executor& executor, const Scene& scene, const Positions& x,
                          const Positions& motion, const HessianChoice& choice,
                          const AssemblyOptions& options = {}) {
  const int n = scene.n_vertices();
  OnExecutor on(executor, scene, x);
  on.rows.uniform_kappa = kappa;
  ExecutorBarrier(cubic(), false).evaluate(executor, on.rows);
  ContactAssembly assembly(executor, on.surface_there, n, options);
  assembly.set_pattern(on.rows);
  Assembled out;
  exec::Buffer<double> gradient(executor, "gradient", 3 * n), force(executor, "force", 3 * n),
      moved(executor, "motion");
  gradient.fill_zero(), force.fill_zero();
  upload(moved, motion);
  assembly.add_gradient(on.rows, on.x, gradient);
  out.gradient = VecXd::Map(gradient.data(), 3 * n);
  const MatrixPart part = assembly.matrix(on.rows, on.x, choice);
  out.matrix = dense(part, n);
  out.n_blocks = assembly.n_blocks(), out.n_rows = on.rows.size();
  assembly.add_given_motion(on.rows, on.x, moved, force);
  out.force = Positions::Map(force.data(), 3, n);
  RowSums sums(executor);
  out.energy = sums.energy(on.rows, on.x, assembly).value();

  const auto add = [&out](const void* data, std::size_t bytes) {
    out.bytes.append(static_cast<const char*>(data), bytes);
  };
  out.bytes = terms_of(on.rows);
  add(part.row_begin, sizeof(Index) * at(n + 1)),
      add(part.column, sizeof(int) * static_cast<std::size_t>(out.n_blocks));
  add(part.value, sizeof(double) * static_cast<std::size_t>(exec::value_count(out.n_blocks)));
  add(gradient.data(), sizeof(double) * at(3 * n)), add(force.data(), sizeof(double) * at(3 * n));
  add(&out.energy, sizeof out.energy);
  return out;
}

inline double relative(const Matrix& a, const Matrix& b) { return (a - b).norm() / b.norm(); }

}  // namespace bb::test
