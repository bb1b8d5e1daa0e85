#include "core/linear/definiteness.hpp"

#include "core/linear/conjugate_gradients.hpp"
#include "core/linear/lanczos.hpp"
#include "core/linear/preconditioner.hpp"

namespace bb {
namespace {

constexpr std::uint64_t side_seed = 20;  // of the right-hand side
constexpr int lanczos_products = 40;     // that improve a direction
constexpr double lanczos_tol = 1e-2;     // of its curvature

// The lowest Ritz vector of A in the Krylov space of the direction, which is part of that space itself.
void improve(const SymmetricProduct& product, Definiteness& out) {
  const auto negated = [&product](const VecXd& x, VecXd& y) {
    product.multiply(x, y);
    y = -y;
  };
  const LanczosEnd end = lanczos_largest(negated, out.direction, lanczos_products, lanczos_tol);
  VecXd image;
  product.multiply(end.vector, image);
  const double lowest = end.vector.dot(image) / end.vector.squaredNorm();
  if (!(lowest < out.curvature)) return;
  out.curvature = lowest;
  out.direction = end.vector;
}

}  // namespace

VecXd definiteness_right_hand_side(Eigen::Index n) { return seeded_vector(n, side_seed); }

Definiteness definiteness_of(const LinearReport& report) {
  Definiteness out;
  out.iterations = report.iterations;
  if (report.status == LinearStatus::ok) out.verdict = Definiteness::Verdict::positive;
  if (report.status == LinearStatus::matrix_indefinite) {
    out.verdict = Definiteness::Verdict::negative;
    ++out.iterations;  // the one that met it
  }
  return out;
}

Definiteness examine_by_gradients(const SymmetricProduct& product, const Preconditioner& preconditioner,
                                  int max_iterations) {
  ConjugateGradients gradients;
  LinearReport report;
  VecXd x;
  const VecXd b = definiteness_right_hand_side(product.n());
  gradients.solve(product, preconditioner, b, definiteness_tolerance, max_iterations, x, report);
  Definiteness out = definiteness_of(report);
  if (out.verdict != Definiteness::Verdict::negative) return out;
  out.direction = gradients.direction();
  VecXd image;
  product.multiply(out.direction, image);
  out.curvature = out.direction.dot(image) / out.direction.squaredNorm();
  improve(product, out);
  return out;
}

Definiteness examine_by_gradients(const ReducedSystem& a, const Preconditioner& preconditioner,
                                  int max_iterations) {
  SymmetricProduct product;
  product.update(a);
  return examine_by_gradients(product, preconditioner, max_iterations);
}

Definiteness examine_preconditioned(const ReducedSystem& a, const NearMatrix& near,
                                    Preconditioner& preconditioner, int max_iterations,
                                    SymmetricProduct& rows) {
  const ReducedSystem& other = near();
  rows.update(other);
  if (preconditioner.setup(other, rows) != LinearStatus::ok) return {};
  rows.update(a);
  return examine_by_gradients(rows, preconditioner, max_iterations);
}

}  // namespace bb
