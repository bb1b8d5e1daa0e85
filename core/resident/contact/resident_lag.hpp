// The contacts of one state as terms keep them on an executor: which points press on each other, in which direction, how hard
// (core/terms/lagged_contacts.hpp). Taken from the rows of contact without a copy on the host.
#pragma once

#include "core/resident/contact/contact_pattern.hpp"
#include "core/resident/contact/lag_kernels.hpp"
#include "core/resident/contact/resident_surface.hpp"

namespace bb::resident {

class ResidentLag {
 public:
  /// surface must outlive it. of_body, of_obstacle: coefficients of the sides of the scene, 1.
  ResidentLag(exec::Executor& executor, const ResidentSurface& surface, int n_vertices, CombineRule rule,
              std::span<const double> of_body, std::span<const double> of_obstacle);

  /// Keeps these rows; they have no strength yet. Errors: as ContactPattern::build.
  void take(ResidentRows& rows);
  /// strength = coefficient times load. contact: the rows that were taken, with their barrier.
  void learn(const RowEnergy& contact);
  bool known() const { return known_; }

  Index size() const { return free_.size(); }
  LagView view(const double* x_n) const {
    return {size(),       vertex_.data(),   weight_.data(), normal_.data(),
            free_.data(), strength_.data(), load_.data(),   x_n};
  }
  const Key* pairs() const { return pair_.data(); }
  double* strength() { return strength_.data(); }

  /// out [3 n_vertices] (N) += forces [3, n] of the rows.
  void add_forces(const double* force, exec::Buffer<double>& out);
  /// hess [6, n] N/m. Both triangles; valid until the next call.
  MatrixPart matrix(const double* hess);
  Index n_blocks() const { return pattern_.n_blocks(); }
  /// Gives the values of the matrix back.
  void free_matrix() { value_.free(); }
  /// What an executor that only counts buffers is to take the rows for.
  void expect(const ExpectedContacts& expected) { pattern_.expect(expected); }

  /// A copy on the host.
  struct Columns {
    std::vector<int> vertex;             // [4, n]
    std::vector<double> weight, normal;  // [4, n], [3, n]
    std::vector<Key> pair;
    std::vector<double> strength, load;
  };
  Columns on_host() const {
    return {vertex_.download(), weight_.download(),   normal_.download(),
            pair_.download(),   strength_.download(), load_.download()};
  }

 private:
  exec::Executor& executor_;
  const ResidentSurface& surface_;
  CombineRule rule_;
  exec::Buffer<double> of_body_, of_obstacle_;
  exec::Buffer<int> vertex_;
  exec::Buffer<double> weight_, normal_, strength_, load_;
  exec::Buffer<std::uint8_t> free_;
  exec::Buffer<Key> pair_;
  ContactPattern pattern_;
  exec::Buffer<double> value_;
  bool known_ = false;
};

}  // namespace bb::resident
