// Gradient and Hessian of the whole E, with active contacts, against differences.
#include <algorithm>
#include <cmath>

#include "core/terms/contact.hpp"
#include "experiments/validity/block.hpp"
#include "experiments/validity/small_scene.hpp"

namespace bb {
namespace {

constexpr double step = 1e-6;  // m

/// The system of two_cloths at a state where no term is at its minimum.
class Disturbed {
 public:
  Disturbed() : small_(two_cloths), system_(small_.scene, small_.method), x_(small_.scene.x0) {
    for (Eigen::Index i = 0; i < x_.size(); ++i) x_(i) += 2e-3 * std::sin(1.7 * static_cast<double>(i) + 0.4);
    prediction_.x_tilde = small_.scene.x0;
  }

  /// Gradient of E at x + move, N, one entry a coordinate.
  VecXd gradient(const VecXd& move) {
    const Positions x = x_ + Eigen::Map<const Positions>(move.data(), 3, x_.cols());
    system_.begin_step(x, prediction_, 0.01, 1);
    system_.assemble();
    return Eigen::Map<const VecXd>(system_.view().gradient().data(), system_.view().gradient().size());
  }
  /// E(x + move) - E(x), J; after gradient(0).
  double change(const VecXd& move) {
    const Positions x = x_ + Eigen::Map<const Positions>(move.data(), 3, x_.cols());
    const Positions dx = x - x_;
    system_.set_direction(dx);
    system_.prepare_motion(MotionEnd::free, false);
    const auto change = system_.try_motion(1);
    return change ? change->change : std::nan("");
  }
  Eigen::Index size() const { return x_.size(); }
  Diagnosis& diagnosis() { return system_.diagnosis(); }
  std::size_t contacts() { return contact_state(diagnosis().terms()).rows.size(); }
  VecXd unit(Eigen::Index i) const { return VecXd::Unit(size(), i); }

 private:
  SmallScene small_;
  NewtonSystem system_;
  Positions x_;
  Prediction prediction_;
};

/// Column i: d gradient/d x_i by central differences, N/m.
Eigen::MatrixXd differences(Disturbed& at) {
  Eigen::MatrixXd out(at.size(), at.size());
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    out.col(i) = (at.gradient(step * at.unit(i)) - at.gradient(-step * at.unit(i))) / (2 * step);
  }
  return out;
}

/// Nothing was judged where no contact is active.
bool no_contact(Disturbed& at, BlockCheck& check) {
  at.gradient(VecXd::Zero(at.size()));
  if (at.contacts() > 0) return false;
  check.detail = "no contact is active";
  return true;
}

}  // namespace

void check_gradient(BlockCheck& check) {
  Disturbed at;
  if (no_contact(at, check)) return;
  const VecXd gradient = at.gradient(VecXd::Zero(at.size()));
  const double largest = gradient.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const double slope = (at.change(step * at.unit(i)) - at.change(-step * at.unit(i))) / (2 * step);
    check.judge(std::abs(slope - gradient[i]) / largest, "coordinate " + std::to_string(i));
  }
}

void check_hessian(BlockCheck& check) {
  Disturbed at;
  if (no_contact(at, check)) return;
  const Eigen::SparseMatrix<double> symmetric = at.diagnosis().exact().lower.selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd hessian = symmetric;
  const Eigen::MatrixXd error = differences(at) - hessian;
  const double largest = hessian.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    check.judge(error.col(i).cwiseAbs().maxCoeff() / largest, "coordinate " + std::to_string(i));
  }
}

void check_symmetry(BlockCheck& check) {
  Disturbed at;
  if (no_contact(at, check)) return;
  const Eigen::MatrixXd h = differences(at);
  const double largest = h.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    check.judge((h.col(i) - h.row(i).transpose()).cwiseAbs().maxCoeff() / largest,
                "coordinate " + std::to_string(i));
  }
}

}  // namespace bb
