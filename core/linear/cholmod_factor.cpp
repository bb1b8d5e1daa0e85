#include "core/linear/cholmod_factor.hpp"

#include <cholmod.h>
#include <sys/mman.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <numeric>
#include <stdexcept>

#include "core/linear/blas_info.hpp"
#include "core/linear/block_starts.hpp"
#include "core/linear/parallel.hpp"
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
  std::vector<int> start, row, permutation;
  std::vector<int> source;  // of each value of `permuted` in A

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
    cholmod_free_sparse(&permuted, &common);
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

  /// Where each value goes, found once a pattern: numbers in the place of values, permuted by CHOLMOD. It would
  /// permute the values anew, twice, in every factorisation.
  void place(cholmod_sparse numbered) {
    std::vector<double> number(numbered.nzmax);
    std::iota(number.begin(), number.end(), 0.0);
    numbered.x = number.data();
    cholmod_free_sparse(&permuted, &common);
    cholmod_sparse* upper =
        cholmod_ptranspose(&numbered, 2, static_cast<int*>(factor->Perm), nullptr, 0, &common);
    if (upper != nullptr) permuted = cholmod_ptranspose(upper, 2, nullptr, nullptr, 0, &common);
    cholmod_free_sparse(&upper, &common);
    require(permuted != nullptr);
    const auto* place = static_cast<const double*>(permuted->x);
    source.resize(numbered.nzmax);
    std::transform(place, place + source.size(), source.begin(),
                   [](double i) { return static_cast<int>(i); });
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
  void require(bool success) {
    if (success && common.status >= CHOLMOD_OK) return;
    key.forget();
    if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    if (common.status == CHOLMOD_TOO_LARGE) {
      throw FactorTooLarge("the factor has more entries than CHOLMOD's 32-bit indices can number");
    }
    throw std::runtime_error("CHOLMOD status " + std::to_string(common.status));
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
  cholmod_sparse a = view(system);
  cholmod_free_factor(&c.factor, &c.common);
  if (analyzed_last_) c.order(system);  // else the ordering was read, and the pattern is its own
  c.factor = cholmod_analyze_p(&a, c.permutation.data(), nullptr, 0, &c.common);
  c.require(c.factor != nullptr);
  c.place(a);
  analyze_s_ = seconds_since(start);
}

void CholmodFactor::keep(Archive& archive) {
  archive(cholmod_->key, cholmod_->permutation);
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

double CholmodFactor::factor_nonzeros() const { return cholmod_->common.lnz; }
double CholmodFactor::factor_flops() const { return cholmod_->common.fl; }

}  // namespace bb
