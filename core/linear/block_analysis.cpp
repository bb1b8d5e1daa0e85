#include "core/linear/block_analysis.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/linear/block_starts.hpp"
#include "core/math/at.hpp"

namespace bb {
namespace {

/// Operations on blocks a vertex from which METIS orders too. METIS takes some 10 us a vertex and saves a tenth to
/// a fifth of the operations on large graphs; 27 operations on numbers make one on blocks of 3, at some 6e9 a second.
constexpr double asks_nested_dissection = 2e4;

const int* ints(const void* list) { return static_cast<const int*>(list); }

/// Degrees of freedom before each block, in the order of the factor.
std::vector<int> permuted_starts(const int* order, const std::vector<int>& first) {
  std::vector<int> start(1, 0);
  for (std::size_t k = 0; k + 1 < first.size(); ++k) {
    const std::size_t block = at(order[k]);
    start.push_back(start.back() + first[block + 1] - first[block]);
  }
  return start;
}

/// Sizes of the rows of a supernode below it, and of the largest product of them that is subtracted from another
/// supernode: what CHOLMOD's numeric factorisation allocates once.
void set_workspace(cholmod_factor& f) {
  const int *super = ints(f.super), *pi = ints(f.pi), *rows = ints(f.s);
  std::vector<int> owner(f.n);
  for (std::size_t s = 0; s < f.nsuper; ++s)
    std::fill(owner.begin() + super[s], owner.begin() + super[s + 1], int(s));
  f.maxcsize = f.maxesize = 1;
  for (std::size_t s = 0; s < f.nsuper; ++s) {
    const int end = pi[s + 1];
    int begin = pi[s] + super[s + 1] - super[s];
    f.maxesize = std::max(f.maxesize, at(end - begin));
    for (int p = begin; p < end; ++p) {
      if (p + 1 < end && owner[at(rows[p + 1])] == owner[at(rows[p])]) continue;
      f.maxcsize = std::max(f.maxcsize, at(end - begin) * at(p + 1 - begin));
      begin = p + 1;
    }
  }
}

int* allocate_ints(std::size_t n, cholmod_common& owner) {
  return static_cast<int*>(cholmod_malloc(n, sizeof(int), &owner));
}

/// A factor of n columns in n_super supernodes, with memory for where those begin. Null when memory runs out.
cholmod_factor* empty_factor(std::size_t n, std::size_t n_super, cholmod_common& owner) {
  cholmod_factor* f = cholmod_allocate_factor(n, &owner);
  if (f == nullptr) return nullptr;
  f->nsuper = n_super;
  f->super = allocate_ints(n_super + 1, owner);
  f->pi = allocate_ints(n_super + 1, owner);
  f->px = allocate_ints(n_super + 1, owner);
  f->is_super = f->is_ll = f->is_monotonic = 1;
  f->xtype = CHOLMOD_PATTERN;
  f->ordering = CHOLMOD_GIVEN;
  if (owner.status < CHOLMOD_OK) cholmod_free_factor(&f, &owner);
  return f;
}

/// Where the columns, rows and values of each supernode begin, and how many there are. start: degrees of freedom before
/// each block. False where an int does not count the values.
bool place_supernodes(const cholmod_factor& blocks, const std::vector<int>& start, cholmod_factor& f) {
  const int *super = ints(blocks.super), *pi = ints(blocks.pi), *rows = ints(blocks.s);
  auto* const f_super = static_cast<int*>(f.super);
  auto* const f_pi = static_cast<int*>(f.pi);
  auto* const f_px = static_cast<int*>(f.px);
  double n_values = 0;
  std::size_t n_rows = 0;
  for (std::size_t s = 0; s < f.nsuper; ++s) {
    f_super[s] = start[at(super[s])];
    f_pi[s] = static_cast<int>(n_rows);
    f_px[s] = static_cast<int>(n_values);
    std::size_t height = 0;
    for (int p = pi[s]; p < pi[s + 1]; ++p) height += at(start[at(rows[p]) + 1] - start[at(rows[p])]);
    n_rows += height;
    n_values += static_cast<double>(height) * (start[at(super[s + 1])] - f_super[s]);
    if (n_values > std::numeric_limits<int>::max()) return false;
  }
  f_super[f.nsuper] = start.back();
  f_pi[f.nsuper] = static_cast<int>(n_rows);
  f_px[f.nsuper] = static_cast<int>(n_values);
  f.ssize = n_rows;
  f.xsize = static_cast<std::size_t>(n_values);
  return true;
}

/// The rows of all supernodes and the order of the columns, block by block.
void expand_rows_and_order(const cholmod_factor& blocks, const std::vector<int>& start,
                           const std::vector<int>& first, cholmod_factor& f) {
  const int *rows = ints(blocks.s), *order = ints(blocks.Perm);
  auto* next = static_cast<int*>(f.s);
  for (int p = 0; p < ints(blocks.pi)[blocks.nsuper]; ++p) {
    for (int i = start[at(rows[p])]; i < start[at(rows[p]) + 1]; ++i) *next++ = i;
  }
  auto* permutation = static_cast<int*>(f.Perm);
  for (std::size_t k = 0; k < blocks.n; ++k) {
    const std::size_t block = at(order[k]);
    for (int i = first[block]; i < first[block + 1]; ++i) *permutation++ = i;
  }
}

/// Every block by its degrees of freedom. Null when memory runs out, or where there are too many values.
cholmod_factor* expanded(const cholmod_factor& blocks, const std::vector<int>& first, cholmod_common& owner) {
  const std::vector<int> start = permuted_starts(ints(blocks.Perm), first);
  cholmod_factor* f = empty_factor(at(start.back()), blocks.nsuper, owner);
  if (f == nullptr) return nullptr;
  if (!place_supernodes(blocks, start, *f)) {
    owner.status = CHOLMOD_TOO_LARGE;
    return cholmod_free_factor(&f, &owner), nullptr;
  }
  f->s = allocate_ints(f->ssize, owner);
  if (f->s == nullptr) return cholmod_free_factor(&f, &owner), nullptr;
  expand_rows_and_order(blocks, start, first, *f);
  set_workspace(*f);
  return f;
}

/// nnz(L) and the sum of the squares of its column lengths, as CHOLMOD counts.
void count(const cholmod_factor& blocks, const std::vector<int>& first, BlockAnalysis& out) {
  const double mean = static_cast<double>(first.back()) / static_cast<double>(blocks.n);
  for (std::size_t k = 0; k < blocks.n; ++k) {
    const std::size_t block = at(ints(blocks.Perm)[k]);
    const int width = first[block + 1] - first[block];
    const double below = mean * (ints(blocks.ColCount)[k] - 1);
    for (int column = 1; column <= width; ++column) {
      out.nonzeros += below + column;
      out.flops += (below + column) * (below + column);
    }
  }
}

}  // namespace

BlockAnalyzer::BlockAnalyzer() {
  cholmod_start(&common_);
  common_.supernodal = CHOLMOD_SUPERNODAL;
  common_.nmethods = 1;
  common_.postorder = 1;
  common_.print = 0;
  // Wider supernodes than CHOLMOD's 4, 16, 48 numbers with 0.8, 0.1, 0.05: small BLAS calls are what holds it back on
  // cloth. Wider still costs more in the solves than it gains (drape matrices 5 x 24^2 and 1 x 48^2). Of blocks of 3.
  const std::size_t columns[] = {8, 16, 32};
  const double zeros[] = {0.5, 0.1, 0.05};
  std::copy_n(columns, 3, common_.nrelax);
  std::copy_n(zeros, 3, common_.zrelax);
}

BlockAnalyzer::~BlockAnalyzer() { cholmod_finish(&common_); }

cholmod_factor* BlockAnalyzer::best_ordering(BlockAnalysis& out) {
  cholmod_sparse graph{};
  graph.nrow = graph.ncol = start_.size() - 1;
  graph.nzmax = row_.size();
  graph.p = start_.data();
  graph.i = row_.data();
  graph.stype = -1;
  graph.itype = CHOLMOD_INT;
  graph.xtype = CHOLMOD_PATTERN;
  graph.sorted = graph.packed = 1;
  common_.method[0].ordering = CHOLMOD_AMD;
  cholmod_factor* best = cholmod_analyze(&graph, &common_);
  out.orderings = 1;
  const double flops = common_.fl;
  if (best == nullptr || !(flops > asks_nested_dissection * static_cast<double>(graph.nrow))) return best;
  common_.method[0].ordering = CHOLMOD_NESDIS;
  cholmod_factor* other = cholmod_analyze(&graph, &common_);
  out.orderings = 2;
  out.nested_dissection = other != nullptr && common_.fl < flops;
  if (out.nested_dissection) std::swap(best, other);
  cholmod_free_factor(&other, &common_);
  return best;
}

BlockAnalysis BlockAnalyzer::analyze(const ReducedSystem& system, cholmod_common& owner) {
  lower_block_columns(system, start_, row_);
  BlockAnalysis out;
  cholmod_factor* blocks = best_ordering(out);
  if (blocks == nullptr) return out;
  out.factor = expanded(*blocks, system.block_start, owner);
  if (out.factor != nullptr) count(*blocks, system.block_start, out);
  cholmod_free_factor(&blocks, &common_);
  return out;
}

}  // namespace bb
