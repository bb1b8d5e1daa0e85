// The cause that a dump names, from the condition numbers of the stages of its iteration.
#include <gtest/gtest.h>

#include "experiments/run/matrix_dump.hpp"

namespace bb::matrix_dump_test {
namespace {

ConditionSample sample(MatrixStage stage, Number cond) {
  ConditionSample s;
  s.stage = stage;
  s.cond = cond;
  return s;
}

TEST(MatrixDump, TheCauseIsTheTermsWithoutWhichCondFallsByTen) {
  using S = MatrixStage;
  const std::vector<std::string> all{"full", "without_contact", "without_contact_and_limit"};
  const auto cause = [&all](double full, double without_contact, double without_both) {
    return cause_of({sample(S::full, full), sample(S::without_contact, without_contact),
                     sample(S::without_contact_and_limit, without_both)},
                    all);
  };
  EXPECT_EQ(cause(1e8, 1e6, 1e6), "contact");
  EXPECT_EQ(cause(1e8, 5e7, 1e4), "strain_limit");
  EXPECT_EQ(cause(1e8, 5e7, 2e7), "elasticity_and_inertia");
}

TEST(MatrixDump, AStageWithoutASampleHasNoActiveTerms) {
  using S = MatrixStage;
  const std::vector<std::string> all{"full", "without_contact", "without_contact_and_limit"};
  EXPECT_EQ(cause_of({sample(S::full, 1e8)}, all), "elasticity_and_inertia");
  EXPECT_EQ(cause_of({sample(S::full, 1e8), sample(S::without_contact_and_limit, 1e4)}, all), "strain_limit");
  EXPECT_EQ(cause_of({sample(S::full, 1e8), sample(S::without_contact_and_limit, 1e4)},
                     {"full", "without_contact_and_limit"}),
            "contact_or_strain_limit");
  EXPECT_EQ(cause_of({sample(S::full, 1e8)}, {"full"}), "");
  EXPECT_EQ(cause_of({}, all), "");
}

TEST(MatrixDump, AMatrixWithoutACondCountsWithTheLargest) {
  using S = MatrixStage;
  EXPECT_EQ(cause_of({sample(S::full, Number::missing("not_pd")), sample(S::without_contact, 1e6)},
                     {"full", "without_contact"}),
            "contact");
}

}  // namespace
}  // namespace bb::matrix_dump_test
