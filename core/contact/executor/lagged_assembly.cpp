#include "core/contact/executor/lagged_assembly.hpp"

#include "core/contact/executor/gather_kernels.hpp"

namespace bb::exec {

LaggedAssembly::LaggedAssembly(Executor& executor, LaggedColumns& columns, int n_vertices)
    : executor_(executor),
      columns_(columns),
      free_(executor, "lagged free vertices"),
      pattern_(executor, n_vertices),
      value_(executor, "lagged matrix values") {}

void LaggedAssembly::take(ExecutorRows& rows) {
  const RowView from = rows.view();
  const auto copy = [&](auto& to, const auto* column) {
    executor_.copy(to.data(), column, static_cast<std::size_t>(to.size()) * sizeof(*column));
  };
  columns_.fit(from.n), free_.fit(from.n);
  copy(columns_.vertex, from.vertex), copy(columns_.weight, from.weight);
  copy(columns_.normal, from.normal), copy(columns_.pair, from.pair), copy(free_, from.free);
  RowStencils stencils{{}, rows.n_slots, rows.n_contributions};
  stencils.rows.n = from.n;
  stencils.rows.vertex = columns_.vertex.data(), stencils.rows.free = free_.data();
  pattern_.build(stencils);
}

void LaggedAssembly::learn(const RowEnergy& contact) {
  executor_.each(columns_.size(), LoadsOfRows{contact, columns_.load.data()});
}

void LaggedAssembly::add_forces(const double* force, PositionsSpan out) {
  if (columns_.size() == 0) return;
  executor_.each(pattern_.n_vertices(),
                 GatherMotions{columns_.weight.data(), columns_.size(), pattern_.slots(), force, out.data()});
}

MatrixPart LaggedAssembly::matrix(const double* hess) {
  const BlockSources blocks = pattern_.blocks();
  const Index n = pattern_.n_blocks();
  value_.fit(value_count(n));
  if (columns_.size() > 0) {
    value_.fill_zero();  // the last plane may be longer than the blocks are
    executor_.each(n,
                   GatherMotionBlocks{columns_.weight.data(), columns_.size(), blocks, hess, value_.data()});
    executor_.each(n, MirrorBlocks{blocks, pattern_.n_vertices(), value_.data()});
  }
  return {blocks.row_begin, blocks.column, value_.data()};
}

}  // namespace bb::exec
