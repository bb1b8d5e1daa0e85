// At what gaps a run carries its loads: weighted quantiles in bins, pair by pair, over the steps.
#include "experiments/run/contact_gaps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/base/archive/archive.hpp"
#include "core/contact/contact_key.hpp"

namespace bb::contact_gaps_test {
namespace {

struct Weighted {
  double value, weight;
};

double exact_quantile(std::vector<Weighted> sample, double q) {
  std::sort(sample.begin(), sample.end(), [](auto& a, auto& b) { return a.value < b.value; });
  double all = 0, below = 0;
  for (const Weighted& one : sample) all += one.weight;
  for (const Weighted& one : sample) {
    below += one.weight;
    if (below >= q * all) return one.value;
  }
  return sample.back().value;
}

TEST(LogHistogram, QuantilesOfRandomSamplesAreThoseOfTheSortedSampleToABin) {
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 20; ++trial) {
    std::uniform_real_distribution<double> exponent(-3.0 - trial, 0), weight(0.01, 1);
    std::vector<Weighted> sample(2000);
    LogHistogram histogram;
    for (Weighted& one : sample) {
      one = {std::exp2(exponent(random)), weight(random)};
      histogram.add(one.value, one.weight);
    }
    for (const double q : {0.05, 0.5, 0.95}) {
      const double found = histogram.quantile(q), exact = exact_quantile(sample, q);
      EXPECT_LT(std::abs(std::log2(found / exact)), 1.01 / 64) << trial << " " << q;
    }
    EXPECT_NEAR(histogram.quantile(0), exact_quantile(sample, 0), 0.011 * histogram.quantile(0));
  }
}

TEST(LogHistogram, AWeightMovesTheQuantileAndNotTheNumberOfValues) {
  LogHistogram histogram;
  for (int i = 0; i < 100; ++i) histogram.add(0.9, 0.001);
  histogram.add(0.1, 1);
  EXPECT_NEAR(histogram.quantile(0.5), 0.1, 0.002);
  EXPECT_NEAR(histogram.quantile(0.95), 0.9, 0.01);
}

/// Two bodies of one vertex each and two obstacles.
Scene two_and_two() {
  Scene scene;
  scene.bodies = {{"one", 0, 1}, {"two", 1, 1}};
  scene.body = {0, 1};
  scene.obstacles.resize(2);
  scene.obstacles[0].name = "floor";
  scene.obstacles[1].name = "a wall";
  return scene;
}
const ContactKey between = {-1, -1, 0, 1}, itself = {-1, -1, 1, 1};

TEST(ContactGaps, EveryPairOfBodiesHasItsOwn) {
  const Scene scene = two_and_two();
  ContactGaps gaps(scene);
  gaps.add({{between, 0.2, 3},
            {obstacle_key(0, std::array{0}), 0.4, 1},
            {obstacle_key(1, std::array{1}), 0.6, 2},
            {itself, 0.8, 4}},
           0.1);
  const GapMap found = gaps.summary();
  ASSERT_EQ(found.size(), 4U);
  const std::pair<const char*, std::pair<double, double>> expected[] = {
      {"one|two", {0.2, 3}}, {"floor|one", {0.4, 1}}, {"a wall|two", {0.6, 2}}, {"two|two", {0.8, 4}}};
  for (const auto& [name, numbers] : expected) {
    ASSERT_TRUE(found.contains(name)) << name;
    const PairGaps& pair = found.at(name);
    EXPECT_NEAR(pair.gap_rel_median, numbers.first, 0.011 * numbers.first) << name;
    EXPECT_NEAR(pair.load_N, numbers.second, 1e-12) << name;
    EXPECT_NEAR(pair.load_share, numbers.second / 10, 1e-12) << name;
    EXPECT_EQ(pair.time_share, 1) << name;
  }
}

/// A step counts with its length: in two parts it is what it is as a whole. One without load counts in the time.
TEST(ContactGaps, AStepCountsWithItsLength) {
  const Scene scene = two_and_two();
  const ContactLoad near = {between, 0.2, 3}, far = {obstacle_key(0, std::array{0}), 0.4, 1};
  ContactGaps whole(scene), parts(scene);
  whole.add({near, far}, 0.25);
  whole.add({near}, 0.75);
  whole.add({}, 1);
  parts.add({near, far}, 0.125);
  parts.add({near, far}, 0.125);
  for (int i = 0; i < 3; ++i) parts.add({near}, 0.25);
  for (int i = 0; i < 4; ++i) parts.add({}, 0.25);
  for (const ContactGaps* gaps : {&whole, &parts}) {
    const GapMap found = gaps->summary();
    EXPECT_DOUBLE_EQ(found.at("one|two").time_share, 0.5);
    EXPECT_DOUBLE_EQ(found.at("one|two").load_N, 1.5);
    EXPECT_DOUBLE_EQ(found.at("floor|one").time_share, 0.125);
    EXPECT_DOUBLE_EQ(found.at("floor|one").load_share, 0.25 / 3.25);
  }
  EXPECT_DOUBLE_EQ(whole.summary().at("one|two").gap_rel_p05, parts.summary().at("one|two").gap_rel_p05);
}

/// Contacts of a pair add up in its load, and touch at one time: a pair of many has load in no more time than one of one.
TEST(ContactGaps, TheTimeOfAPairIsThatOfItsStepsHoweverManyContactsItHas) {
  const Scene scene = two_and_two();
  const ContactLoad one = {between, 0.2, 3}, other = {between, 0.3, 1},
                    floor = {obstacle_key(0, std::array{0}), 0.4, 2};
  ContactGaps gaps(scene);
  gaps.add({one, other, floor, one}, 0.25);
  gaps.add({floor, other, one, other, other}, 0.25);
  gaps.add({}, 0.5);
  const GapMap found = gaps.summary();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_DOUBLE_EQ(found.at("one|two").time_share, 0.5);
  EXPECT_DOUBLE_EQ(found.at("floor|one").time_share, 0.5);
  EXPECT_DOUBLE_EQ(found.at("one|two").load_N, 0.25 * (7 + 6));
  EXPECT_DOUBLE_EQ(found.at("floor|one").load_N, 0.25 * 4);
  double shares = 0;
  for (const auto& [name, pair] : found) {
    EXPECT_LE(pair.time_share, 1) << name;
    shares += pair.load_share;
  }
  EXPECT_DOUBLE_EQ(shares, 1);
}

TEST(ContactGaps, ACheckpointKeepsThem) {
  const Scene scene = two_and_two();
  ContactGaps whole(scene), begun(scene), rest(scene);
  whole.add({{between, 0.2, 3}}, 0.1);
  begun.add({{between, 0.2, 3}}, 0.1);
  Archive archive;
  begun.keep(archive);
  Archive again(archive.bytes());
  rest.keep(again);
  EXPECT_TRUE(again.at_end());
  for (ContactGaps* gaps : {&whole, &rest})
    gaps->add({{between, 0.7, 2}, {obstacle_key(0, std::array{1}), 0.3, 2}}, 0.2);
  const GapMap one = whole.summary(), other = rest.summary();
  ASSERT_EQ(one.size(), 2U);
  for (const auto& [name, pair] : one) {
    EXPECT_EQ(pair.gap_rel_median, other.at(name).gap_rel_median);
    EXPECT_EQ(pair.load_share, other.at(name).load_share);
    EXPECT_EQ(pair.time_share, other.at(name).time_share);
  }
}

TEST(ContactGaps, WithoutLoadThereIsNoPair) {
  const Scene scene = two_and_two();
  ContactGaps gaps(scene);
  EXPECT_TRUE(gaps.summary().empty());
  gaps.add({}, 1);
  EXPECT_TRUE(gaps.summary().empty());
}

}  // namespace
}  // namespace bb::contact_gaps_test
