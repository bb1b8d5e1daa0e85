#include "core/resident/contact/contact_sums.hpp"

namespace bb::resident {

ContactSums::ContactSums(exec::Executor& executor)
    : executor_(executor), part_(executor, "contact sums"), folded_(executor, "contact sums") {}

template <class Item>
CompensatedSum ContactSums::sum(Index n, const Item& item) {
  if (n == 0) return {0, 0, 0};
  const auto n_blocks = [](Index items) { return (items + exec::block_threads - 1) / exec::block_threads; };
  Index left = n_blocks(n);
  part_.resize(left);
  folded_.resize(n_blocks(left));
  executor_.blocks(left, SumItems<Item>{item, n, part_.data()});
  while (left > 1) {
    executor_.blocks(n_blocks(left), FoldSums{part_.data(), left, folded_.data()});
    left = n_blocks(left);
    part_.swap(folded_);
  }
  return executor_.counts_only() ? CompensatedSum{0, 0, 0} : part_.get(0);
}

CompensatedSum ContactSums::energy(ResidentRows& rows, const exec::Buffer<double>& x,
                                   ContactAssembly& assembly) {
  const exec::Buffer<double>& mollifiers = assembly.mollifiers(rows, x);
  return sum(rows.size(), RowEnergy{rows.view(), {rows.list.data(), rows.list.size(), mollifiers.data()}});
}

double ContactSums::product(const exec::Buffer<double>& a, const exec::Buffer<double>& b,
                            const exec::Buffer<std::uint8_t>& fixed) {
  return sum(a.size(), FreeProduct{a.data(), b.data(), fixed.data()}).value();
}

double ContactSums::mean_mass(ResidentRows& rows, const exec::Buffer<double>& mass) {
  const RowView view = rows.view();
  return sum(view.n, RowMass{view, mass.data()}).value() / sum(view.n, RowPoints{view}).value();
}

}  // namespace bb::resident
