// Which BLAS kernel a process may run: every answer of the switch, over made-up machines.
#include "core/linear/blas_kernel.hpp"

#include <gtest/gtest.h>

#include "core/linear/blas_info.hpp"

namespace bb::blas_kernel_test {
namespace {

BlasKernelFacts machine(const std::string& running, const std::string& environment = "") {
  return {running, environment, true, true};
}

TEST(BlasKernel, TheFixedOneIsTheDefaultAndNeedsOneRestart) {
  EXPECT_EQ(choose_blas_kernel({}, machine("SkylakeX")).action, BlasKernelAction::restart);
  EXPECT_EQ(choose_blas_kernel("haswell", machine("Zen")).action, BlasKernelAction::restart);
  EXPECT_EQ(choose_blas_kernel({}, machine("Haswell", "Haswell")).action, BlasKernelAction::keep);
  EXPECT_EQ(choose_blas_kernel("haswell", machine("Haswell")).action, BlasKernelAction::keep);
}

TEST(BlasKernel, WhatTheUserNamesIsKept) {
  EXPECT_EQ(choose_blas_kernel("native", machine("SkylakeX")).action, BlasKernelAction::keep);
  EXPECT_EQ(choose_blas_kernel({}, machine("Zen", "Zen")).action, BlasKernelAction::keep);
  // The flag of the program is nearer than the environment.
  EXPECT_EQ(choose_blas_kernel("haswell", machine("Zen", "Zen")).action, BlasKernelAction::restart);
}

TEST(BlasKernel, WhereItCannotRunTheReasonIsTold) {
  BlasKernelFacts old_processor = machine("Sandybridge");
  old_processor.cpu_has_avx2_fma = false;
  BlasKernelFacts other_library = machine("SkylakeX");
  other_library.dynamic_arch = false;
  const BlasKernelFacts deaf_library = machine("SkylakeX", "haswell");  // a second restart would never end
  const std::pair<BlasKernelFacts, const char*> cases[] = {
      {old_processor, "AVX2"}, {other_library, "DYNAMIC_ARCH"}, {deaf_library, "OPENBLAS_CORETYPE"}};
  for (const auto& [facts, word] : cases) {
    const BlasKernelChoice choice = choose_blas_kernel("haswell", facts);
    EXPECT_EQ(choice.action, BlasKernelAction::refuse) << word;
    EXPECT_NE(choice.reason.find(word), std::string::npos) << choice.reason;
  }
  EXPECT_EQ(choose_blas_kernel("native", old_processor).action, BlasKernelAction::keep);
}

TEST(BlasKernel, TheFactsAreThoseOfThisProcess) {
  const BlasKernelFacts facts = blas_kernel_facts();
  EXPECT_FALSE(facts.running.empty());
  EXPECT_EQ(facts.running, blas_info().kernel);
  EXPECT_EQ(blas_info().requested, facts.environment.empty() ? "native" : facts.environment);
}

}  // namespace
}  // namespace bb::blas_kernel_test
