#include "core/linear/cholmod_factor.hpp"

#include <cholmod.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <stdexcept>

#include "core/linear/blas_info.hpp"
#include "core/linear/block_starts.hpp"
#include "core/linear/pattern_key.hpp"

namespace bb {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A CHOLMOD header over Eigen's arrays: no copy.
cholmod_sparse view(const ReducedSystem& system) {
  const auto& lower = system.lower;
  cholmod_sparse a{};
  a.nrow = a.ncol = static_cast<std::size_t>(lower.rows());
  a.nzmax = static_cast<std::size_t>(lower.nonZeros());
  a.p = const_cast<int*>(lower.outerIndexPtr());
  a.i = const_cast<int*>(lower.innerIndexPtr());
  a.x = const_cast<double*>(lower.valuePtr());
  a.stype = -1;  // lower triangle of a symmetric matrix
  a.itype = CHOLMOD_INT;
  a.xtype = CHOLMOD_REAL;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = a.packed = 1;
  return a;
}

}  // namespace

struct CholmodFactor::Cholmod {
  cholmod_common common{};
  cholmod_factor* factor = nullptr;
  cholmod_dense *x = nullptr, *y = nullptr, *e = nullptr;  // workspaces of solve
  PatternKey key;
  std::vector<int> start, row, permutation;

  Cholmod() {
    set_one_blas_thread();
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    common.postorder = 1;
    // Wider supernodes than CHOLMOD's 4, 16, 48 with 0.8, 0.1, 0.05: small BLAS calls are what holds it back
    // on cloth. Wider still costs more in the solves than it gains (drape matrices 5 x 24^2 and 1 x 48^2).
    const std::size_t columns[] = {24, 48, 96};
    const double zeros[] = {0.5, 0.1, 0.05};
    std::copy_n(columns, 3, common.nrelax);
    std::copy_n(zeros, 3, common.zrelax);
    common.print = 0;
    common.quick_return_if_not_posdef = 1;
  }
  ~Cholmod() {
    cholmod_free_dense(&x, &common);
    cholmod_free_dense(&y, &common);
    cholmod_free_dense(&e, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  /// Nested dissection by METIS of the graph of the vertices, whose degrees of freedom stay together: the same
  /// fill as from the graph of degrees of freedom, in two thirds of the time.
  void order(const ReducedSystem& system) {
    const std::vector<int>& first = system.block_start;
    lower_block_columns(system, start, row);
    cholmod_sparse graph{};
    graph.nrow = graph.ncol = first.size() - 1;
    graph.nzmax = row.size();
    graph.p = start.data();
    graph.i = row.data();
    graph.stype = -1;
    graph.itype = CHOLMOD_INT;
    graph.xtype = CHOLMOD_PATTERN;
    graph.sorted = graph.packed = 1;
    std::vector<int> vertex(graph.nrow), parent(graph.nrow), member(graph.nrow);
    require(cholmod_nested_dissection(&graph, nullptr, 0, vertex.data(), parent.data(), member.data(),
                                      &common) >= 0);
    permutation.clear();
    for (const int v : vertex) {
      const auto b = static_cast<std::size_t>(v);
      for (int i = first[b]; i < first[b + 1]; ++i) permutation.push_back(i);
    }
  }

  /// Resource failures are exceptions; the numerical warnings are not seen here.
  void require(bool success) {
    if (success && common.status >= CHOLMOD_OK) return;
    key.forget();
    if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    if (common.status == CHOLMOD_TOO_LARGE) throw std::length_error("CHOLMOD: factor exceeds 32-bit indices");
    throw std::runtime_error("CHOLMOD status " + std::to_string(common.status));
  }
};

CholmodFactor::CholmodFactor() : cholmod_(std::make_unique<Cholmod>()) {}
CholmodFactor::~CholmodFactor() = default;

LinearStatus CholmodFactor::factorize(const ReducedSystem& system) {
  Cholmod& c = *cholmod_;
  set_one_blas_thread();  // the OpenMP part holds for the calling thread only
  cholmod_sparse a = view(system);
  const double* value = system.lower.valuePtr();
  analyze_s_ = factor_s_ = 0;
  analyzed_last_ = !c.key.same_as_last(system) || c.factor == nullptr;
  if (analyzed_last_) {
    const auto start = std::chrono::steady_clock::now();
    cholmod_free_factor(&c.factor, &c.common);
    c.order(system);
    c.factor = cholmod_analyze_p(&a, c.permutation.data(), nullptr, 0, &c.common);
    c.require(c.factor != nullptr);
    analyze_s_ = seconds_since(start);
  }
  if (!std::all_of(value, value + a.nzmax, [](double v) { return std::isfinite(v); })) {
    return LinearStatus::non_finite;
  }
  const auto start = std::chrono::steady_clock::now();
  c.require(cholmod_factorize(&a, c.factor, &c.common) != 0);
  factor_s_ = seconds_since(start);
  return c.common.status == CHOLMOD_NOT_POSDEF || c.factor->minor < c.factor->n
             ? LinearStatus::matrix_indefinite
             : LinearStatus::ok;
}

void CholmodFactor::solve(const VecXd& b, VecXd& x) {
  Cholmod& c = *cholmod_;
  cholmod_dense rhs{};
  rhs.nrow = rhs.d = rhs.nzmax = static_cast<std::size_t>(b.size());
  rhs.ncol = 1;
  rhs.x = const_cast<double*>(b.data());
  rhs.xtype = CHOLMOD_REAL;
  rhs.dtype = CHOLMOD_DOUBLE;
  c.require(cholmod_solve2(CHOLMOD_A, c.factor, &rhs, nullptr, &c.x, nullptr, &c.y, &c.e, &c.common) != 0);
  x = Eigen::Map<const VecXd>(static_cast<const double*>(c.x->x), b.size());
}

double CholmodFactor::factor_nonzeros() const { return cholmod_->common.lnz; }
double CholmodFactor::factor_flops() const { return cholmod_->common.fl; }

}  // namespace bb
