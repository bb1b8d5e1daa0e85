#include "core/contact/executor/contact_assembly.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/contact/executor/gather_kernels.hpp"

namespace bb::exec {

ContactAssembly::ContactAssembly(Executor& executor, const ExecutorSurface& surface, int n_vertices,
                                 const AssemblyOptions& options)
    : executor_(executor),
      surface_(surface),
      options_(options),
      pattern_(executor, n_vertices, options.pairs_a_chunk),
      mollified_(executor, "mollified gradients"),
      mollifier_(executor, "mollifiers"),
      row_hessians_(executor, "row Hessians"),
      value_(executor, "contact matrix values") {}

void ContactAssembly::set_pattern(ExecutorRows& rows, bool blocks) {
  if (blocks) {
    pattern_.build(rows);
  } else {
    pattern_.build_slots(rows);
  }
}

void ContactAssembly::mollify(ExecutorRows& rows, const PositionsView& x) {
  const Index n = rows.list.size();
  mollified_.fit(12 * n);
  mollifier_.fit(n);
  executor_.each(n, MollifiedGradients{{rows.view(), surface_.view(), x.data()},
                                       rows.list.data(),
                                       n,
                                       mollified_.data(),
                                       mollifier_.data()});
}

RowEnergy ContactAssembly::row_energy(ExecutorRows& rows, const PositionsView& x) {
  mollify(rows, x);
  return {rows.view(), {rows.list.data(), rows.list.size(), mollifier_.data()}};
}

void ContactAssembly::add_gradient(ExecutorRows& rows, const PositionsView& x, PositionsSpan gradient) {
  mollify(rows, x);
  gather(rows, RowForce{}, gradient);
}

/// Requires the numbers of the mollified rows.
template <class Term>
void ContactAssembly::gather(ExecutorRows& rows, const Term& term, PositionsSpan out) {
  const MollifiedColumn mollified{rows.list.data(), rows.list.size(), mollified_.data()};
  executor_.each(pattern_.n_vertices(),
                 GatherRows<Term>{rows.view(), pattern_.slots(), mollified, term, out.data()});
}

void ContactAssembly::add_given_motion(ExecutorRows& rows, const PositionsView& x,
                                       const PositionsView& motion, PositionsSpan force) {
  const Index n = rows.list.size();
  mollified_.fit(12 * n);
  executor_.each(
      n,
      MollifiedChanges{
          {rows.view(), surface_.view(), x.data()}, rows.list.data(), n, motion.data(), mollified_.data()});
  gather(rows, RowGivenMotion{motion.data()}, force);
}

MatrixPart ContactAssembly::matrix(ExecutorRows& rows, const PositionsView& x, const HessianChoice& choice) {
  if (is_numeric(choice.mode)) {
    throw std::invalid_argument(
        "numeric projections of contact Hessians have no kernel; gauss_newton and projected_full have");
  }
  const Index n = pattern_.n_blocks();
  value_.fit(value_count(n));
  const BlockSources blocks = pattern_.blocks();
  if (rows.size() > 0) {
    value_.fill_zero();  // the last plane may be longer than the blocks are
    executor_.each(n, GatherStreamed{rows.view(), blocks, x.data(), surface_.view(), choice, value_.data()});
    add_hessians(rows, x, choice);
    executor_.each(n, MirrorBlocks{blocks, pattern_.n_vertices(), value_.data()});
  }
  return {blocks.row_begin, blocks.column, value_.data()};
}

// Without those of sliding rows a list of the mollified ones is all that there is; with them nearly every row has one.
void ContactAssembly::add_hessians(ExecutorRows& rows, const PositionsView& x, const HessianChoice& choice) {
  const bool listed = choice.mode == HessianMode::gauss_newton;
  const Index n = listed ? rows.list.size() : rows.size(), stride = std::min(options_.hessians_a_chunk, n);
  row_hessians_.fit(row_numbers * stride);
  for (Index first = 0; first < n; first += stride) {
    const Index size = std::min(stride, n - first);
    const RowChunk chunk{listed ? rows.list.data() + first : nullptr, first, size};
    const RowHessians to{rows.view(), chunk, stride, row_hessians_.data(), x.data(), surface_.view(), choice};
    if (rows.list.size() > 0) executor_.each(size, MollifiedHessians{to});
    if (!listed) executor_.each(size, SlidingHessians{to});
    executor_.each(16 * size, GatherDense{rows.view(), pattern_.blocks(), chunk, choice.mode, stride,
                                          row_hessians_.data(), value_.data()});
  }
}

}  // namespace bb::exec
