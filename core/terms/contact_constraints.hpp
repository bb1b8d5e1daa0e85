// The gaps of contact as constraints: d >= 0, one a row, whatever the barrier is.
#pragma once

#include <vector>

#include "core/contact/contact_table.hpp"
#include "core/energy/constraint_batch.hpp"

namespace bb {

/// C = d of a row, with the weights and the normal that it has where the rows were found: exact of an obstacle that is a
/// plane, to first order of the motion since of others.
class ContactConstraints final : public ConstraintBatch {
 public:
  /// Rows of the state x [3 x n] m. compliant: inverse stiffness 1/kappa, m/N, of the kappa that the rows have; else 0.
  void set(const ContactTable& rows, const MollifiedTable& mollified, const PositionsView& x, bool compliant);

  std::string_view name() const override { return "contact"; }
  ConstraintKind kind() const override { return ConstraintKind::inequality; }
  std::string_view unit() const override { return "m"; }
  int width() const override { return 4; }
  std::span<const int> vertices() const override { return vertices_; }
  std::span<const double> compliance() const override { return compliance_; }
  double value(std::size_t e, const PositionsView& x, double* gradient) const override;
  std::ptrdiff_t before(std::size_t e) const override { return before_[e]; }

 private:
  /// Where the constraint of a pair is.
  struct Place {
    PairId pair;
    std::size_t at;
  };
  void find_before(const std::vector<PairId>& rows, const std::vector<PairId>& mollified);
  template <class Table>
  void add(const Table& rows, const PositionsView& x, bool compliant);

  std::vector<int> vertices_;           // [4 n]
  std::vector<double> weight_;          // [4 n] 1
  std::vector<double> normal_;          // [3 n] 1
  std::vector<double> level_;           // [n] m, C - n . sum w_i x_i
  std::vector<double> compliance_;      // [n] m/N
  std::vector<std::ptrdiff_t> before_;  // [n]
  std::vector<Place> places_, now_;     // in the order of the pairs
};

}  // namespace bb
