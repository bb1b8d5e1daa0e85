// All terms with fixed stencils in an executor's memory: loads, elastic elements, strain limit. What NewtonSystem does
// with such terms on the CPU, with everything but scalars staying where it is.
#pragma once

#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "core/resident/elements/element_family.hpp"
#include "core/resident/elements/gather_lists.hpp"
#include "core/resident/elements/load_kernels.hpp"
#include "core/resident/elements/resident_limit.hpp"
#include "core/resident/linear/resident_matrix.hpp"
#include "core/resident/sums/resident_sum.hpp"
#include "core/terms/term_options.hpp"

namespace bb::resident {

/// The Hessian that a term, by its name, has in the matrix.
using HessianOf = std::function<HessianRequest(std::string_view term)>;
/// Every element clamped.
inline HessianRequest clamped_hessian(std::string_view) { return {}; }

class ResidentElements {
 public:
  /// Elements that have local terms at a time: 90 numbers a hinge, so 180 MiB.
  static constexpr Index default_piece = Index{1} << 18;

  /// scene and options must outlive it. Results do not depend on `piece`. Errors: ConfigError for a precision other
  /// than full, for a limit's shape without a kernel, for what the batches of core/energy refuse; OutOfMemory.
  ResidentElements(exec::Executor& executor, const Scene& scene, const TermOptions& options,
                   Index piece = default_piece);

  // --- a step; x always [3 n] m
  void begin_step(const ResidentFrame& frame);
  /// The same step with another prediction and length.
  void change_frame(const ResidentFrame& frame) { frame_ = frame; }

  // --- an iterate x. Order: matrix of the elastic terms where something reads it, refresh_limit, linearise, matrix
  /// matrix() = 0.
  void clear_matrix();
  /// matrix() += the terms of a set: elastic ones first, inertia, limit. The limit's Hessians need refresh_limit(x).
  void add_matrix(TermSet set, const double* x, const HessianOf& hessian);
  /// Both triangles, prescribed vertices included.
  MatrixPart matrix() const { return {row_begin_.data(), column_.data(), value_.data()}; }
  Index n_blocks() const { return column_.size(); }
  /// Whether the next refresh_limit reads matrix(): the clamped elastic one then.
  bool limit_reads_matrix() const { return limit_ && limit_->reads_elastic(); }
  /// kappa of the strain limit. Returns its largest relative change.
  double refresh_limit(const double* x);
  /// g [3 n] = gradient, N; energies of the iterate. After refresh_limit(x).
  void linearise(const double* x, double* g);
  /// Adds the energies of the iterate, J.
  void add_energy(TermSet set, const double* x, ResidentSum& sum) const;

  // --- a trial state
  /// Whether x is within the strain limit; evaluate(x) comes next, or nothing of it.
  bool admits(const double* x);
  void evaluate(const double* x);
  /// Adds E(trial x1) - E(iterate x0), element by element, J.
  void add_change(const double* x0, const double* x1, ResidentSum& sum) const;
  /// The trial becomes the iterate.
  void accept();
  /// Largest alpha in [0, 1] up to which x + alpha dx is within the strain limit. park: in units of its width.
  double bound(const double* x, const double* dx, double park);

  // --- what is said of an iterate
  /// Measures. Zeros, and no gap, without a limit.
  LimitNumbers limit_numbers(const double* x);
  /// First element with an energy that is not finite, as term and number; empty name without one.
  struct BadElement {
    std::string_view term;
    Index element = -1;
  };
  BadElement first_not_finite() const;
  Index n_vertices() const { return n_vertices_; }

 private:
  struct Slot {
    std::unique_ptr<ElementFamily> family;
    Buffer<double> energy, trial;      // [n] J
    std::vector<GatherLists> gathers;  // one a piece
  };
  void add_slot(std::unique_ptr<ElementFamily> family);
  /// f(piece, gathers) of all pieces of a family.
  template <class F>
  void for_each_piece(const Slot& slot, const F& f) const;
  void add_hessians(const Slot& slot, const double* x, const HessianRequest& request);
  Loads loads() const;

  exec::Executor& executor_;
  const Scene& scene_;
  Index n_vertices_, piece_;
  ResidentFrame frame_;
  std::vector<Slot> slots_;         // elastic families, then the limit
  ResidentLimit* limit_ = nullptr;  // its family in slots_
  Buffer<double> mass_;
  Buffer<Index> row_begin_;
  Buffer<int> column_;
  Buffer<double> value_;
  Buffer<double> local_;  // gradients or Hessians of a piece
  mutable ResidentLeast least_;
};

}  // namespace bb::resident
