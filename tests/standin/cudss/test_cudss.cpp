// The linear solver cudss through the compiled device executor and a stand-in for the library: solutions, how often the
// pattern is analysed, what fails and what is reported then.
#include "core/exec/executor.hpp"
#include "core/linear/cudss/library.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/math/error.hpp"
#include "tests/linear/systems.hpp"
#include "tests/standin/cudss/fixture.hpp"
#include "tests/standin/messages.hpp"

namespace standin {
CudssState& cudss() {
  static CudssState one;
  return one;
}
}  // namespace standin

namespace bb {
namespace {

std::unique_ptr<LinearSolver> solver(const char* name = "cudss") {
  LinearOptions options;
  options.name = name;
  return make_linear_solver(options);
}

/// The distance to the solution of CHOLMOD, relative to it.
double distance(const ReducedSystem& system, const VecXd& b, const VecXd& x) {
  VecXd expected;
  EXPECT_EQ(solver("cholmod")->solve(system, b, expected).status, LinearStatus::ok);
  EXPECT_GT(expected.norm(), 0);
  return (x - expected).norm() / expected.norm();
}

using test::expect_parts;
using test::message;

TEST_F(CudssStandin, SolvesAsCholmod) {
  ASSERT_EQ(missing_for("cudss"), "");
  for (const int side : {2, 8, 20}) {
    const ReducedSystem system = grid_system(side, 0.1, 1);
    const VecXd b = random_vector(system.lower.rows(), 2);
    VecXd x;
    const LinearReport report = solver()->solve(system, b, x);
    EXPECT_EQ(report.status, LinearStatus::ok) << report.detail;
    EXPECT_LT(distance(system, b, x), 1e-12);
    EXPECT_LT(report.residual_true, 1e-13);
    EXPECT_FALSE(report.iterative);
    EXPECT_TRUE(report.analyzed && report.factorized);
    EXPECT_EQ(report.factor_nnz, 1234);
    EXPECT_EQ(report.factor_flop, 0);
  }
  EXPECT_EQ(standin::cudss().solves, 3);
}

TEST_F(CudssStandin, AnalysesOnceAPattern) {
  const auto cudss = solver();
  ReducedSystem first = grid_system(8, 0.1, 1), second = grid_system(8, 0.4, 1);
  ReducedSystem folded = folded_grid(8, 3), nameless = grid_system(8, 0.1, 0);
  folded.pattern_id = 2;
  struct Solve {
    const ReducedSystem& system;
    bool analyzes;
  };
  const Solve solves[] = {{first, true},  {second, false}, {folded, true},   {folded, false},
                          {first, true},  {first, false},  {nameless, true}, {nameless, true},
                          {second, true}, {second, false}};
  int analyses = 0, n = 0;
  for (const Solve& one : solves) {
    const VecXd b = random_vector(one.system.lower.rows(), 2);
    VecXd x;
    const LinearReport report = cudss->solve(one.system, b, x);
    ASSERT_EQ(report.status, LinearStatus::ok) << n;
    EXPECT_LT(distance(one.system, b, x), 1e-12) << n;
    EXPECT_EQ(report.analyzed, one.analyzes) << n;
    EXPECT_EQ(report.analyze_s > 0, one.analyzes) << n;
    analyses += one.analyzes;
    EXPECT_EQ(standin::cudss().analyses, analyses) << n;
    EXPECT_EQ(standin::cudss().factorizations, ++n);
  }
}

TEST_F(CudssStandin, AMatrixThatIsNotPositiveDefiniteIsAStatus) {
  const auto cudss = solver();
  const ReducedSystem good = grid_system(8, 0.1, 1);
  ReducedSystem bad = good;
  bad.lower.coeffRef(30, 30) = -1;
  const VecXd b = random_vector(good.lower.rows(), 2);
  VecXd x;
  const LinearReport report = cudss->solve(bad, b, x);
  EXPECT_EQ(report.status, solver("cholmod")->solve(bad, b, x).status);
  EXPECT_EQ(report.status, LinearStatus::matrix_indefinite);
  expect_parts(report.detail, {"not positive definite", "CUDSS_DATA_INFO 7"});
  EXPECT_TRUE(report.analyzed);
  EXPECT_FALSE(report.factorized);
  EXPECT_EQ(report.factor_nnz, 0);
  EXPECT_EQ(report.residual_true, 1);
  EXPECT_EQ(standin::cudss().solves, 0);
  EXPECT_EQ(cudss->solve(good, b, x).status, LinearStatus::ok);
  EXPECT_LT(distance(good, b, x), 1e-12);
  EXPECT_EQ(standin::cudss().analyses, 1);
}

TEST_F(CudssStandin, WhatIsNotFiniteGoesNowhere) {
  const auto cudss = solver();
  const ReducedSystem good = grid_system(4, 0.1, 1);
  ReducedSystem bad = good;
  bad.lower.valuePtr()[3] = NAN;
  VecXd b = random_vector(good.lower.rows(), 2), x;
  EXPECT_EQ(cudss->solve(bad, b, x).status, LinearStatus::non_finite);
  EXPECT_EQ(x, VecXd::Zero(b.size()));
  EXPECT_EQ(standin::cudss().analyses + standin::cudss().factorizations, 0);
  EXPECT_EQ(cudss->solve(good, b, x).status, LinearStatus::ok);
  b[2] = INFINITY;
  EXPECT_EQ(cudss->solve(good, b, x).status, LinearStatus::non_finite);
  EXPECT_EQ(standin::cudss().solves, 1);
}

// Of every call in turn: the name and the status are reported, and the next solve begins anew.
TEST_F(CudssStandin, AnErrorNamesTheCallAndItsStatus) {
  const ReducedSystem system = grid_system(4, 0.1, 1);
  const VecXd b = random_vector(system.lower.rows(), 2);
  VecXd x;
  const auto attempt = [&] { solver()->solve(system, b, x); };
  for (const char* call : {"cudssCreate", "cudssSetStream", "cudssSetDeviceMemHandler", "cudssConfigCreate",
                           "cudssConfigSet", "cudssDataCreate", "cudssMatrixCreateCsr", "cudssMatrixCreateDn",
                           "CUDSS_DATA_LU_NNZ", "CUDSS_DATA_INFO"}) {
    standin::cudss().failing = call;
    expect_parts(message<exec::ExecutionError>(attempt),
                 {"cuDSS", call, "CUDSS_STATUS_EXECUTION_FAILED (5)"});
  }
  const auto cudss = solver();
  int analyses = standin::cudss().analyses;
  for (const auto& [phase, word] :
       {std::pair{"analysis", "the analysis"}, std::pair{"factorization", "the factorisation"},
        std::pair{"solve", "the solve"}}) {
    standin::cudss().failing = phase;
    standin::cudss().status = CUDSS_STATUS_INTERNAL_ERROR;
    expect_parts(message<exec::ExecutionError>([&] { cudss->solve(system, b, x); }),
                 {word, "CUDSS_STATUS_INTERNAL_ERROR (6)"});
    standin::cudss().failing = "";
    analyses = standin::cudss().analyses;
    EXPECT_EQ(cudss->solve(system, b, x).status, LinearStatus::ok);
    EXPECT_LT(distance(system, b, x), 1e-12);
    EXPECT_EQ(standin::cudss().analyses, analyses + 1);
  }
}

TEST_F(CudssStandin, EveryStatusHasItsName) {
  EXPECT_EQ(cudss::status_text(CUDSS_STATUS_SUCCESS), "CUDSS_STATUS_SUCCESS (0)");
  EXPECT_EQ(cudss::status_text(CUDSS_STATUS_ALLOC_FAILED), "CUDSS_STATUS_ALLOC_FAILED (2)");
  EXPECT_EQ(cudss::status_text(CUDSS_STATUS_NOT_SUPPORTED), "CUDSS_STATUS_NOT_SUPPORTED (4)");
}

// Its own memory is the executor's: named where it does not fit.
TEST_F(CudssStandin, MemoryThatRunsOutIsNamed) {
  const ReducedSystem system = grid_system(4, 0.1, 1);
  const VecXd b = random_vector(system.lower.rows(), 2);
  VecXd x;
  const auto cudss = solver();
  standin::cudss().factor_bytes = std::size_t{1} << 40;
  expect_parts(message<exec::OutOfMemory>([&] { cudss->solve(system, b, x); }),
               {"cuDSS", "1.00 TiB", "free on the card"});
  standin::settings().memory = standin::counts().in_use + 2000;
  standin::cudss().factor_bytes = 4096;
  expect_parts(message<exec::OutOfMemory>([&] { cudss->solve(folded_grid(12, 1), b.replicate(9, 1), x); }),
               {"free on the card"});
  standin::settings() = {};
  standin::cudss().failing = "factorization";
  standin::cudss().status = CUDSS_STATUS_ALLOC_FAILED;
  expect_parts(message<exec::OutOfMemory>([&] { cudss->solve(system, b, x); }),
               {"CUDSS_STATUS_ALLOC_FAILED (2)"});
  standin::cudss().failing = "";
  EXPECT_EQ(cudss->solve(system, b, x).status, LinearStatus::ok);
  EXPECT_LT(distance(system, b, x), 1e-12);
}

TEST_F(CudssStandin, WhatIsMissingIsSaid) {
  struct Case {
    std::function<void()> set;
    std::vector<std::string> says;
  };
  const auto file = [](const char* name) { return [name] { setenv("BARRIERBENCH_CUDSS", name, 1); }; };
  const Case cases[] = {
      {file("/nowhere/libcudss.so"), {"/nowhere/libcudss.so", "cannot open", "BARRIERBENCH_CUDSS"}},
      {file("libm.so.6"), {"libm.so.6", "it has no function cudssGetProperty"}},
      {[] { standin::cudss().major = CUDSS_VERSION_MAJOR + 1; },
       {"of version 2", "of this build of version 1"}},
      {[] { standin::cudss().failing = "cudssGetProperty"; }, {"cudssGetProperty", "EXECUTION_FAILED"}},
      {[] { standin::settings().count = 0; }, {"no card here", "no NVIDIA card was found"}},
  };
  for (const Case& c : cases) {
    SetUp();
    EXPECT_EQ(missing_for("cudss"), "");
    c.set();
    expect_parts(message<ConfigError>([] { solver(); }),
                 {"/linear_solver/name", "\"cudss\"", "another solver"});
    expect_parts(missing_for("cudss"), c.says);
  }
}

}  // namespace
}  // namespace bb
