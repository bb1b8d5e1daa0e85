#include "core/contact/executor/contact_sums.hpp"

namespace bb::exec {

template <class Parts>
Compensated RowSums::sum(Index n, const Parts& parts) {
  sum_.clear();
  sum_.add(n, parts);
  return sum_.get();
}

void RowSums::look_at_energy(ExecutorRows& rows, const PositionsView& x, ContactAssembly& assembly) {
  energy_.clear();
  energy_.add(rows.size(), assembly.row_energy(rows, x));
}

double RowSums::product(const PositionsView& a, const PositionsView& b, const Buffer<std::uint8_t>& fixed) {
  return sum(a.size(), FreeDot{a.data(), b.data(), fixed.data()}).value();
}

double RowSums::mean_mass(ExecutorRows& rows, const Buffer<double>& mass) {
  const RowView view = rows.view();
  return sum(view.n, RowMass{view, mass.data()}).value() / sum(view.n, RowPoints{view}).value();
}

}  // namespace bb::exec
