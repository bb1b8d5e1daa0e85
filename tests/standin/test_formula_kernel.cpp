// A shape whose kernel came after the program was built: PTX that nvcc made of formula_log.cu or formula_functions.cu, which analysis/src/barrierbench_analysis/program/formula wrote,
// loaded and launched by the device executor. Linked once with the stand-in for the CUDA run time, once with CUDA's own, where
// it needs a card.
#include <gtest/gtest.h>

#include <cmath>

#include "barriers/formulas.hpp"
#include "barriers/shapes/registry.hpp"
#include "core/contact/executor/executor_barrier.hpp"
#include "core/contact/executor/given_shape.hpp"
#include "core/exec/cuda/device.hpp"
#include "core/exec/cuda/device_executor.hpp"
#include "core/exec/host_executor.hpp"
#include "core/math/error.hpp"
#include "tests/standin/formula_shapes/sample.hpp"
#ifdef BB_STANDIN
#include "tests/standin/cudart.hpp"
#endif

extern const char formula_ptx[];

namespace bb::formula_kernel_test {
namespace {

using exec::ExecutorBarrier;
using exec::ExecutorRows;
using exec::Index;
using exec::KappaColumns;
using exec::RowView;

constexpr Index n_gaps = 400;
constexpr const char* entry = "barrierbench_shape";

const DeviceCode& of_the_sample(const Shape&, std::uint64_t) {
  static const DeviceCode code{formula_ptx, entry, "", ""};
  return code;
}

/// Gaps from deep inside to beyond d_hat, 0 among them, each with a kappa.
struct Gaps {
  std::vector<double> d, d_hat, kappa;
  Gaps() {
    for (Index r = 0; r < n_gaps; ++r) {
      d_hat.push_back(0.01 * static_cast<double>(1 + r % 3));
      d.push_back(r == 0 ? 0.0 : d_hat.back() * std::pow(10.0, -6 + 6.2 * static_cast<double>(r) / n_gaps));
      kappa.push_back(100.0 + static_cast<double>(r));
    }
  }
};

class FormulaKernel : public testing::TestWithParam<Argument> {
 protected:
  void SetUp() override {
    const cuda::DeviceProbe probe = cuda::probe_device();
#ifdef BB_STANDIN
    standin::reset();
    ASSERT_TRUE(probe.usable) << probe.why;
#else
    if (!probe.usable) GTEST_SKIP() << probe.why;
#endif
    device = std::make_unique<cuda::DeviceExecutor>();
    barrier = {sample_shape(), GetParam()};
    barrier.shape.name = "formula:" + std::string(sample_formula), barrier.shape.launches = nullptr;
    barrier.shape.device_code = of_the_sample;
  }
  std::unique_ptr<cuda::DeviceExecutor> device;
  BarrierFunction barrier;
};

double relative(double a, double b) { return a == b ? 0 : std::abs(a - b) / std::abs(b); }

struct Terms {
  std::vector<double> energy, force, stiffness;
};

/// kept: a kappa each; else 150 N/m for all.
Terms on_the_device(cuda::DeviceExecutor& device, const BarrierFunction& barrier, const Gaps& gaps,
                    bool kept) {
  constexpr std::size_t bytes = n_gaps * sizeof(double);
  ExecutorRows rows(device, kept ? KappaColumns::kept : KappaColumns::uniform);
  rows.resize(n_gaps);
  rows.uniform_kappa = 150;
  const RowView v = rows.view();
  device.upload(v.d, gaps.d.data(), bytes);
  device.upload(v.d_hat, gaps.d_hat.data(), bytes);
  if (kept) device.upload(v.kappa, gaps.kappa.data(), bytes);
  const ExecutorBarrier barrier_there(barrier, false);
  for (int i = 0; i < 2; ++i) barrier_there.evaluate(device, rows);  // loaded once
  Terms out{std::vector<double>(n_gaps), std::vector<double>(n_gaps), std::vector<double>(n_gaps)};
  device.download(out.energy.data(), v.energy, bytes);
  device.download(out.force.data(), v.force, bytes);
  device.download(out.stiffness.data(), v.stiffness, bytes);
  return out;
}

TEST_P(FormulaKernel, HasTheNumbersOfTheShapeInEveryRow) {
  const Gaps gaps;
  int n_active = 0;
  for (const bool kept : {true, false}) {
    const Terms found = on_the_device(*device, barrier, gaps, kept);
    for (std::size_t r = 0; r < n_gaps; ++r) {
      const ShapeTerms<double> one = barrier.eval(gaps.d[r], gaps.d_hat[r]);
      const double kappa = kept ? gaps.kappa[r] : 150;
      ASSERT_LE(relative(found.energy[r], kappa * one.b), sample_tolerance) << gaps.d[r];
      ASSERT_LE(relative(found.force[r], kappa * one.db), sample_tolerance) << gaps.d[r];
      ASSERT_LE(relative(found.stiffness[r], kappa * one.d2b), sample_tolerance) << gaps.d[r];
      n_active += found.force[r] < 0;
    }
  }
  EXPECT_GT(n_active, 600);
  EXPECT_LT(n_active, 2 * n_gaps);
#ifdef BB_STANDIN
  EXPECT_EQ(standin::counts().fault, "");
  EXPECT_EQ(standin::counts().libraries, 1);
  device.reset();
  EXPECT_EQ(standin::counts().libraries, 0);
#endif
}
INSTANTIATE_TEST_SUITE_P(Arguments, FormulaKernel, testing::Values(Argument::gap, Argument::squared_gap));

/// What the executor reports of a launch with this code; empty where it throws nothing.
std::string refusal(cuda::DeviceExecutor& device, const DeviceCode& code) {
  exec::KernelInfo info = exec::each_info<exec::EvaluateGivenShape>();
  info.code = &code;
  try {
    device.each(1, exec::EvaluateGivenShape{}, info);
  } catch (const exec::ExecutionError& error) {
    return error.what();
  }
  return "";
}

/// PTX without what it reports of the card and the compiler.
std::string kernel_in(const std::string& ptx) {
  const std::size_t begin = ptx.find(".visible .entry"), end = ptx.rfind('}');
  return begin < end ? ptx.substr(begin, end - begin) : "no kernel in " + ptx;
}

/// From the text on: the program gets from analysis/src/barrierbench_analysis/program/formula the library and the kernel, which is that of the sample.
using KernelOfAText = FormulaKernel;
TEST_P(KernelOfAText, IsMadeWhenItIsAskedFor) {
  try {
    barrier.shape = require_formula(sample_formula, {}, "shape").shape;
  } catch (const ConfigError& error) {
    if (std::string(error.what()).find("no Python at") == std::string::npos) throw;
    GTEST_SKIP() << error.what();
  }
  ASSERT_TRUE(barrier.shape.device_code);
  const DeviceCode& code = barrier.shape.device_code(barrier.shape, exec::given_shape_layout);
  EXPECT_EQ(kernel_in(code.ptx), kernel_in(formula_ptx));
  EXPECT_EQ(code.sha256.size(), 64u);
  const Gaps gaps;
  const Terms found = on_the_device(*device, barrier, gaps, true);
  const double most = sample_calls_library ? sample_tolerance : 0;
  for (std::size_t r = 0; r < n_gaps; ++r) {
    const ShapeTerms<double> one = barrier.eval(gaps.d[r], gaps.d_hat[r]);
    ASSERT_LE(relative(found.energy[r], gaps.kappa[r] * one.b), most) << gaps.d[r];
    ASSERT_LE(relative(found.force[r], gaps.kappa[r] * one.db), most) << gaps.d[r];
    ASSERT_LE(relative(found.stiffness[r], gaps.kappa[r] * one.d2b), most) << gaps.d[r];
  }
  EXPECT_LT(found.force[n_gaps / 2], 0);
}
INSTANTIATE_TEST_SUITE_P(Gap, KernelOfAText, testing::Values(Argument::gap));

using RefusedCode = FormulaKernel;
TEST_P(RefusedCode, IsNamedWithWhatIsWrong) {
  std::string larger = formula_ptx;
  const std::string size = std::string(entry) + "_param_1[";
  const std::size_t at = larger.find(size) + size.size();
  ASSERT_LT(at, larger.size());
  larger.insert(at, "9");
  EXPECT_NE(refusal(*device, {larger, entry, "", ""}).find(" on the device"), std::string::npos);
  EXPECT_NE(refusal(*device, {formula_ptx, "another", "", ""}).find("PTX without a kernel another"),
            std::string::npos);
  const std::string broken = "no PTX, but " + size + std::to_string(sizeof(exec::EvaluateGivenShape)) + "]";
  EXPECT_NE(refusal(*device, {broken, entry, "", ""}).find("cudaLibraryLoadData"), std::string::npos);
}
INSTANTIATE_TEST_SUITE_P(Gap, RefusedCode, testing::Values(Argument::gap));

TEST(ExecutorBarrier, RefusesAShapeThatHasNoKernelAndBringsNone) {
  BarrierFunction barrier{require_shape("cubic")};
  barrier.shape.name = "from_a_plugin", barrier.shape.launches = nullptr;
  EXPECT_THROW(ExecutorBarrier(barrier, false), ConfigError);
  barrier.shape.device_code = of_the_sample;
  EXPECT_NO_THROW(ExecutorBarrier(barrier, false));
  EXPECT_THROW(ExecutorBarrier(barrier, true), ConfigError);  // no kernel with a potential
}

}  // namespace
}  // namespace bb::formula_kernel_test
