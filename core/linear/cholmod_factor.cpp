#include "core/linear/cholmod_factor.hpp"

#include <cholmod.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <stdexcept>

#include "core/linear/blas_info.hpp"
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

  Cholmod() {
    set_one_blas_thread();
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
    common.postorder = 1;
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
    c.factor = cholmod_analyze(&a, &c.common);
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
