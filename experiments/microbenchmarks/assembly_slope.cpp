// assembly_slope: how the time to assemble contact rows on a host executor grows with their number, from 2^16 rows to
// 2^22. Stacks of ever more sheets, so that every row has the same neighbours: one line of JSON a stack, then the slopes
// in log-log of pattern, gradient, matrix and all of it (1: linear). Times are those of the processor, of all threads, so
// that other work on the machine changes them little. About 7 GB and some minutes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <vector>

#include "barriers/shapes/registry.hpp"
#include "core/contact/executor/contact_assembly.hpp"
#include "core/contact/executor/executor_barrier.hpp"
#include "core/contact/executor/executor_broad_phase.hpp"
#include "core/contact/executor/row_finder.hpp"
#include "core/exec/host_executor.hpp"
#include "experiments/microbenchmarks/cloth_stack.hpp"

namespace {

using namespace bb;

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Processor seconds of the fastest of three calls.
template <class F>
double seconds(const F& f) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double begin = processor_seconds();
    f();
    least = std::min(least, processor_seconds() - begin);
  }
  return least;
}

struct Times {
  double rows, pattern, gradient, matrix, all;  // s
};

Times measure(int layers) {
  constexpr int vertices_a_side = 40;
  const Scene scene = bench::cloth_stack(layers, vertices_a_side);
  const ContactPlan plan = plan_contact(scene);
  exec::HostExecutor executor;
  const Surface surface(scene);
  const exec::ExecutorSurface on(executor, scene, surface);
  exec::Buffer<double> x(executor, "positions"), gradient(executor, "gradient");
  x.upload({scene.x0.data(), static_cast<std::size_t>(scene.x0.size())});
  gradient.resize(x.size());
  exec::ExecutorCandidates candidates(executor);
  exec::ExecutorBroadPhase(executor, on, surface, plan).update(x, x, candidates);
  exec::ExecutorRows rows(executor, exec::KappaColumns::uniform);
  exec::RowFinder(executor, on, plan.mollifier.needed).find(x, candidates, rows);
  rows.uniform_kappa = 1;
  exec::ExecutorBarrier({require_shape("log"), Argument::gap}, false).evaluate(executor, rows);

  exec::ContactAssembly assembly(executor, on, scene.n_vertices());
  const exec::HessianChoice choice{HessianMode::projected_full, Projection::psd, false, 1};
  Times out{static_cast<double>(rows.size()), 0, 0, 0, 0};
  out.pattern = seconds([&] { assembly.set_pattern(rows); });
  out.gradient = seconds([&] { assembly.add_gradient(rows, x, gradient); });
  out.matrix = seconds([&] { assembly.matrix(rows, x, choice); });
  out.all = out.pattern + out.gradient + out.matrix;
  return out;
}

/// Of log y over log x, by least squares.
double slope(const std::vector<Times>& all, double Times::*y) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Times& one : all) {
    const double a = std::log(one.rows), b = std::log(one.*y);
    n += 1, sx += a, sy += b, sxx += a * a, sxy += a * b;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace

int main() {
  std::vector<Times> all;
  for (int sheets_apart = 1; all.empty() || all.back().rows < 0x1p22; sheets_apart *= 2) {
    const Times t = measure(1 + sheets_apart);
    if (t.rows < 0x1p16) continue;
    all.push_back(t);
    std::printf("{\"rows\": %.0f, \"pattern_s\": %.4f, \"gradient_s\": %.4f, \"matrix_s\": %.4f}\n", t.rows,
                t.pattern, t.gradient, t.matrix);
    std::fflush(stdout);
  }
  std::printf(
      "{\"slope_pattern\": %.3f, \"slope_gradient\": %.3f, \"slope_matrix\": %.3f, \"slope_all\": %.3f}\n",
      slope(all, &Times::pattern), slope(all, &Times::gradient), slope(all, &Times::matrix),
      slope(all, &Times::all));
  return 0;
}
