// Mixed weights: the sum of layers times influences, cut off, with influences that follow keys.
#include <gtest/gtest.h>

#include "core/model/scene/weight_mix.hpp"

namespace bb::weight_mix_test {
namespace {

TEST(WeightMix, is_the_sum_of_its_layers_cut_off_at_0_and_1) {
  const WeightMix mix{{{{0, 0.5, 1, 0.2}, 0.5, {}}, {{1, 1, 1, 0}, 0.75, {}}, {{0, 0, 0, 1}, -0.5, {}}}};
  EXPECT_EQ(mix.at(3), (std::vector<double>{0.75, 1, 1, 0}));
  EXPECT_TRUE(mix.given());
  EXPECT_FALSE(WeightMix().given());
}

TEST(WeightMix, follows_the_keys_of_its_influences) {
  const WeightMix mix{{{{1, 0.5}, 0.9, {{1, 0}, {3, 1}}}, {{0, 0.25}, 1, {}}}};
  EXPECT_EQ(mix.at(0), (std::vector<double>{0, 0.25}));
  EXPECT_EQ(mix.at(2), (std::vector<double>{0.5, 0.5}));
  EXPECT_EQ(mix.at(5), (std::vector<double>{1, 0.75}));
}

TEST(WeightMix, of_an_element_is_the_mean_of_its_vertices) {
  EXPECT_EQ(mean_weight<2>({0.5, 1, 0.25}, {0, 2}), 0.375);
  EXPECT_EQ(mean_weight<3>({0.5, 1, 0}, {7, 8, 9}, 7), 0.5);
}

}  // namespace
}  // namespace bb::weight_mix_test
