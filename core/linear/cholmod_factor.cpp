#include "core/linear/cholmod_factor.hpp"

#include <cholmod.h>
#include <sys/mman.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <stdexcept>

#include "core/linear/blas_info.hpp"
#include "core/linear/block_analysis.hpp"
#include "core/linear/block_starts.hpp"
#include "core/linear/parallel.hpp"
#include "core/linear/pattern_key.hpp"
#include "core/math/at.hpp"

namespace bb {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// OpenBLAS takes a buffer of 128 MiB when it is first used and waits for ever where it gets none: then memory has
/// run out. Errors: std::bad_alloc. Cost: once a process.
void require_blas_buffer() {
  static const bool there = [] {
    constexpr std::size_t bytes = std::size_t{160} << 20;
    void* place = mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (place == MAP_FAILED) throw std::bad_alloc();
    munmap(place, bytes);
    return true;
  }();
  static_cast<void>(there);
}

}  // namespace

struct CholmodFactor::Cholmod {
  cholmod_common common{};
  cholmod_factor* factor = nullptr;
  cholmod_dense *x = nullptr, *y = nullptr, *e = nullptr;  // workspaces of solve
  cholmod_sparse* permuted = nullptr;                      // P A P^T, lower, as the factorisation reads it
  PatternKey key;
  BlockAnalyzer analyzer;
  double nonzeros = 0, flops = 0;   // of the factor
  std::vector<int> source;          // of each value of `permuted` in A
  std::vector<int> position, next;  // scratch of place

  Cholmod() {
    set_one_blas_thread();
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.print = 0;
    common.quick_return_if_not_posdef = 1;
  }
  ~Cholmod() {
    cholmod_free_dense(&x, &common);
    cholmod_free_dense(&y, &common);
    cholmod_free_dense(&e, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&permuted, &common);
    cholmod_finish(&common);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  /// Where each value goes, found once a pattern: CHOLMOD would permute the values anew, twice, in every
  /// factorisation. Rows of a column stay unsorted: they are only scattered into the factor.
  void place(const ReducedSystem& system) {
    const int *outer = system.lower.outerIndexPtr(), *inner = system.lower.innerIndexPtr();
    const std::size_t n = factor->n, n_nonzeros = static_cast<std::size_t>(system.lower.nonZeros());
    cholmod_free_sparse(&permuted, &common);
    permuted = cholmod_allocate_sparse(n, n, n_nonzeros, 0, 1, -1, CHOLMOD_REAL, &common);
    require(permuted != nullptr);
    const auto* permutation = static_cast<const int*>(factor->Perm);
    position.resize(n);
    for (std::size_t k = 0; k < n; ++k) position[at(permutation[k])] = static_cast<int>(k);
    auto *start = static_cast<int*>(permuted->p), *row = static_cast<int*>(permuted->i);
    std::fill_n(start, n + 1, 0);
    const auto for_each_entry = [&](const auto& f) {
      for (std::size_t j = 0; j < n; ++j) {
        for (int k = outer[j]; k < outer[j + 1]; ++k) {
          const int a = position[j], b = position[at(inner[k])];
          f(std::max(a, b), at(std::min(a, b)), k);
        }
      }
    };
    for_each_entry([&](int, std::size_t column, int) { ++start[column + 1]; });
    for (std::size_t j = 0; j < n; ++j) start[j + 1] += start[j];
    next.assign(start, start + n);
    source.resize(n_nonzeros);
    for_each_entry([&](int r, std::size_t column, int k) {
      const std::size_t to = at(next[column]++);
      row[to] = r;
      source[to] = k;
    });
  }

  bool factorize(const double* value) {
    auto* out = static_cast<double*>(permuted->x);
    parallel_items(source.size(), 16 * block_items,
                   [&](std::size_t k) { out[k] = value[static_cast<std::size_t>(source[k])]; });
    factor->ordering = CHOLMOD_NATURAL;  // of what it is given now
    const bool success = cholmod_factorize(permuted, factor, &common) != 0;
    factor->ordering = CHOLMOD_GIVEN;  // for solve
    return success;
  }

  /// Resource failures are exceptions; the numerical warnings are not seen here.
  /// other: the status of another workspace that took part.
  void require(bool success, int other = CHOLMOD_OK) {
    const int status = std::min(common.status, other);
    if (success && status >= CHOLMOD_OK) return;
    key.forget();
    if (status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    if (status == CHOLMOD_TOO_LARGE) {
      throw FactorTooLarge("the factor has more entries than CHOLMOD's 32-bit indices can number");
    }
    throw std::runtime_error("CHOLMOD status " + std::to_string(status));
  }
};

CholmodFactor::CholmodFactor() : cholmod_(std::make_unique<Cholmod>()) {}
CholmodFactor::~CholmodFactor() = default;

void CholmodFactor::analyze(const ReducedSystem& system) {
  Cholmod& c = *cholmod_;
  analyze_s_ = 0;
  analyzed_last_ = !c.key.same_as_last(system);
  if (!analyzed_last_ && c.factor != nullptr) return;
  const auto start = std::chrono::steady_clock::now();
  cholmod_free_factor(&c.factor, &c.common);
  const BlockAnalysis analysis = c.analyzer.analyze(system, c.common);
  c.factor = analysis.factor;
  c.nonzeros = analysis.nonzeros;
  c.flops = analysis.flops;
  c.require(c.factor != nullptr, c.analyzer.common().status);
  c.place(system);
  analyze_s_ = seconds_since(start);
}

void CholmodFactor::keep(Archive& archive) {
  archive(cholmod_->key);
  if (archive.reads()) cholmod_free_factor(&cholmod_->factor, &cholmod_->common);
}

LinearStatus CholmodFactor::factorize(const ReducedSystem& system) {
  Cholmod& c = *cholmod_;
  set_one_blas_thread();  // the OpenMP part holds for the calling thread only
  require_blas_buffer();
  analyze(system);
  const double* value = system.lower.valuePtr();
  factor_s_ = 0;
  if (!std::all_of(value, value + system.lower.nonZeros(), [](double v) { return std::isfinite(v); })) {
    return LinearStatus::non_finite;
  }
  const auto start = std::chrono::steady_clock::now();
  c.require(c.factorize(value));
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

std::string CholmodFactor::failure(const ReducedSystem& system) const {
  const cholmod_factor& factor = *cholmod_->factor;
  const int dof = static_cast<const int*>(factor.Perm)[std::min(factor.minor, factor.n - 1)];
  return "no positive pivot at " + vertex_text(system, dof);
}

double CholmodFactor::factor_nonzeros() const { return cholmod_->nonzeros; }
double CholmodFactor::factor_flops() const { return cholmod_->flops; }

}  // namespace bb
