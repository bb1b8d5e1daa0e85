// Names for Eigen's fixed-size values. Everything stacked is vertex-major: x.col(i) is vertex i.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross

#include "core/math/host_device.hpp"

namespace bb {

template <class T, int N>
using Vec = Eigen::Matrix<T, N, 1>;
template <class T, int R, int C>
using Mat = Eigen::Matrix<T, R, C>;

using Vec2d = Vec<double, 2>;
using Vec3d = Vec<double, 3>;
using Mat3d = Mat<double, 3, 3>;
using VecXd = Eigen::VectorXd;

/// [3 x n_vertices] positions (m), velocities (m/s) or forces (N); contiguous, 3 numbers a vertex.
using Positions = Eigen::Matrix3Xd;

/// A buffer of 3 n_vertices numbers (core/exec/buffer.hpp).
template <class Column>
concept IsColumn = requires(Column& column) {
  static_cast<const double*>(column.data());
  column.size();
  column.bytes();
};

/// Positions in memory that another object owns, nothing is copied: the host's, or that of an executor, whose kernels alone read
/// them then.
class PositionsView : public Eigen::Map<const Positions> {
 public:
  template <IsColumn Column>
  PositionsView(const Column& x) : Map(x.data(), 3, x.size() / 3) {}  // NOLINT(google-explicit-constructor)
  PositionsView(const Positions& x) : Map(x.data(), 3, x.cols()) {}   // NOLINT(google-explicit-constructor)
  /// x: 3 n_vertices numbers.
  PositionsView(const double* x, Eigen::Index n_vertices) : Map(x, 3, n_vertices) {}
};

/// The same to write to.
class PositionsSpan : public Eigen::Map<Positions> {
 public:
  template <IsColumn Column>
  PositionsSpan(Column& x) : Map(x.data(), 3, x.size() / 3) {}  // NOLINT(google-explicit-constructor)
  PositionsSpan(Positions& x) : Map(x.data(), 3, x.cols()) {}   // NOLINT(google-explicit-constructor)
  PositionsSpan(double* x, Eigen::Index n_vertices) : Map(x, 3, n_vertices) {}
  using Map::operator=;
  operator PositionsView() const { return {data(), cols()}; }  // NOLINT(google-explicit-constructor)
};

}  // namespace bb
