#include "core/resident/contact/resident_lag.hpp"

#include "core/resident/contact/gather_kernels.hpp"

namespace bb::resident {

ResidentLag::ResidentLag(exec::Executor& executor, const ResidentSurface& surface, int n_vertices,
                         CombineRule rule, std::span<const double> of_body,
                         std::span<const double> of_obstacle)
    : executor_(executor),
      surface_(surface),
      rule_(rule),
      of_body_(executor, "coefficients of bodies"),
      of_obstacle_(executor, "coefficients of obstacles"),
      vertex_(executor, "lagged vertices"),
      weight_(executor, "lagged weights"),
      normal_(executor, "lagged normals"),
      strength_(executor, "lagged strengths"),
      load_(executor, "lagged loads"),
      free_(executor, "lagged free vertices"),
      pair_(executor, "lagged pairs"),
      pattern_(executor, n_vertices),
      value_(executor, "lagged matrix values") {
  of_body_.upload(of_body);
  of_obstacle_.upload(of_obstacle);
}

void ResidentLag::take(ResidentRows& rows) {
  const RowView from = rows.view();
  const auto copy = [&](auto& to, const auto* column, Index n) {
    to.fit(n);
    executor_.copy(to.data(), column, static_cast<std::size_t>(n) * sizeof(*column));
  };
  copy(vertex_, from.vertex, 4 * from.n), copy(weight_, from.weight, 4 * from.n);
  copy(normal_, from.normal, 3 * from.n), copy(free_, from.free, from.n), copy(pair_, from.pair, from.n);
  for (auto* column : {&strength_, &load_}) {
    column->fit(from.n);
    column->fill_zero();
  }
  known_ = false;
  RowStencils stencils{{}, rows.n_slots, rows.n_contributions};
  stencils.rows.n = from.n;
  stencils.rows.vertex = vertex_.data(), stencils.rows.free = free_.data();
  pattern_.build(stencils);
}

void ResidentLag::learn(const RowEnergy& contact) {
  const SideCoefficients sides{of_body_.data(), of_obstacle_.data(), rule_};
  executor_.each(size(), LearnLoads{contact, sides, surface_.view().body, load_.data(), strength_.data()});
  known_ = true;
}

void ResidentLag::add_forces(const double* force, exec::Buffer<double>& out) {
  if (size() == 0) return;
  executor_.each(pattern_.n_vertices(), GatherMotions{view(nullptr), pattern_.slots(), force, out.data()});
}

MatrixPart ResidentLag::matrix(const double* hess) {
  const BlockSources blocks = pattern_.blocks();
  const Index n = pattern_.n_blocks();
  value_.fit(value_count(n));
  if (size() > 0) {
    value_.fill_zero();  // the last plane may be longer than the blocks are
    executor_.each(n, GatherMotionBlocks{view(nullptr), blocks, hess, value_.data()});
    executor_.each(n, MirrorBlocks{blocks, pattern_.n_vertices(), value_.data()});
  }
  return {blocks.row_begin, blocks.column, value_.data()};
}

}  // namespace bb::resident
