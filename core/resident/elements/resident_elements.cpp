#include "core/resident/elements/resident_elements.hpp"

#include <algorithm>

#include "core/math/error.hpp"
#include "core/math/lower_blocks.hpp"
#include "core/resident/sums/vector_kernels.hpp"

namespace bb::resident {

ResidentElements::ResidentElements(exec::Executor& executor, const Scene& scene, const TermOptions& options,
                                   Index piece)
    : executor_(executor),
      scene_(scene),
      n_vertices_(scene.n_vertices()),
      piece_(piece),
      mass_(executor, "vertex masses"),
      row_begin_(executor, "element matrix rows"),
      column_(executor, "element matrix columns"),
      value_(executor, "element matrix values"),
      local_(executor, "local terms of elements"),
      least_(executor) {
  if (options.precision != Precision::full) {
    throw ConfigError("precision", "of the elements", "double: kernels have no other");
  }
  std::vector<MadeFamily> made = make_elastic_families(executor, scene);
  MadeFamily limit;
  if (auto family = make_limit(executor, scene, options, limit.vertices)) {
    limit_ = family.get();
    limit.family = std::move(family);
    made.push_back(std::move(limit));
  }
  std::vector<Stencils> stencils;
  stencils.reserve(made.size());
  for (const MadeFamily& one : made) stencils.push_back({one.family->width(), one.vertices});
  const BlockRows rows = block_rows(scene.n_vertices(), stencils);
  row_begin_.upload(rows.row_begin);
  column_.upload(rows.column);
  value_.resize(value_count(n_blocks()));
  mass_.upload(scene.mass);
  for (std::size_t i = 0; i < made.size(); ++i) {
    add_slot(std::move(made[i].family));
    Slot& slot = slots_.back();
    const auto width = static_cast<std::size_t>(stencils[i].width);
    for (Index begin = 0; begin < slot.family->size(); begin += piece_) {
      const auto n = static_cast<std::size_t>(std::min(piece_, slot.family->size() - begin));
      const Stencils part{stencils[i].width,
                          stencils[i].vertices.subspan(width * static_cast<std::size_t>(begin), width * n)};
      slot.gathers.emplace_back(executor_, part, rows);
    }
  }
}

void ResidentElements::add_slot(std::unique_ptr<ElementFamily> family) {
  const Index n = family->size();
  const auto numbers = static_cast<Index>(n_lower_numbers(static_cast<std::size_t>(family->width())));
  local_.resize(std::max(local_.size(), numbers * std::min(piece_, n)));
  slots_.push_back({std::move(family),
                    Buffer<double>(executor_, "element energies", n),
                    Buffer<double>(executor_, "element energies of the trial", n),
                    {}});
}

template <class F>
void ResidentElements::for_each_piece(const Slot& slot, const F& f) const {
  for (std::size_t i = 0; i < slot.gathers.size(); ++i) {
    const Index begin = static_cast<Index>(i) * piece_;
    f(Piece{begin, std::min(piece_, slot.family->size() - begin)}, slot.gathers[i]);
  }
}

Loads ResidentElements::loads() const {
  const Vec3d& g = scene_.gravity;
  return {mass_.data(), frame_.x_n,         frame_.x_tilde,     frame_.dt,
          frame_.c,     frame_.load_factor, {g[0], g[1], g[2]}, !g.isZero(0)};
}

void ResidentElements::begin_step(const ResidentFrame& frame) {
  frame_ = frame;
  if (limit_) limit_->begin_step();
}

void ResidentElements::clear_matrix() { value_.fill_zero(); }

void ResidentElements::add_hessians(const Slot& slot, const double* x, const HessianRequest& request) {
  for_each_piece(slot, [&](const Piece& piece, const GatherLists& gathers) {
    slot.family->hessians(piece, request, x, local_.data());
    gathers.add_hessians(executor_, piece.n, local_.data(), value_.data());
  });
}

void ResidentElements::add_matrix(TermSet set, const double* x, const HessianOf& hessian) {
  const auto add_group = [&](TermGroup group) {
    for (const Slot& slot : slots_) {
      if (set.has(group) && slot.family->group() == group)
        add_hessians(slot, x, hessian(slot.family->name()));
    }
  };
  add_group(TermGroup::elastic);
  if (set.has(TermGroup::load)) {
    executor_.each(n_vertices_, InertiaDiagonal{loads(), row_begin_.data(), column_.data(), value_.data()});
  }
  if (limit_ && set.has(TermGroup::limit)) limit_->measure(x);
  add_group(TermGroup::limit);
  executor_.each(n_vertices_, MirrorRow{row_begin_.data(), column_.data(), value_.data()});
}

double ResidentElements::refresh_limit(const double* x) {
  return limit_ ? limit_->refresh(x, frame_, mass_.data(), matrix()) : 0;
}

void ResidentElements::linearise(const double* x, double* g) {
  executor_.each(n_vertices_, LoadGradient{loads(), x, g});
  if (limit_) limit_->measure(x);
  for (Slot& slot : slots_) {
    double* energy = slot.energy.data();
    for_each_piece(slot, [&](const Piece& piece, const GatherLists& gathers) {
      slot.family->gradients(piece, x, energy, local_.data());
      gathers.add_gradients(executor_, piece.n, local_.data(), g);
    });
  }
}

void ResidentElements::add_energy(TermSet set, const double* x, ResidentSum& sum) const {
  if (set.has(TermGroup::load)) sum.add(n_vertices_, LoadEnergies{loads(), x});
  for (const Slot& slot : slots_) {
    if (set.has(slot.family->group())) sum.add(slot.energy.size(), ColumnSum{slot.energy.data()});
  }
}

bool ResidentElements::admits(const double* x) {
  if (!limit_) return true;
  limit_->measure(x);
  return limit_->feasible();
}

void ResidentElements::evaluate(const double* x) {
  for (Slot& slot : slots_) slot.family->values(x, slot.trial.data());
}

void ResidentElements::add_change(const double* x0, const double* x1, ResidentSum& sum) const {
  sum.add(n_vertices_, LoadChanges{loads(), x0, x1});
  for (const Slot& slot : slots_) {
    sum.add(slot.energy.size(), ColumnChange{slot.energy.data(), slot.trial.data()});
  }
}

void ResidentElements::accept() {
  for (Slot& slot : slots_) slot.energy.swap(slot.trial);
}

double ResidentElements::bound(const double* x, const double* dx, double park) {
  return limit_ ? limit_->bound(x, dx, park) : 1;
}

LimitNumbers ResidentElements::limit_numbers(const double* x) {
  if (!limit_) return {0, 0, std::numeric_limits<double>::infinity()};
  limit_->measure(x);
  return limit_->numbers();
}

ResidentElements::BadElement ResidentElements::first_not_finite() const {
  for (const Slot& slot : slots_) {
    least_.clear();
    executor_.each(slot.energy.size(), FirstNotFinite{slot.energy.data(), least_.data()});
    if (const Index first = least_.first(); first >= 0) return {slot.family->name(), first};
  }
  return {};
}

}  // namespace bb::resident
