// The block matrix against dense assembly: values, restriction, patterns and their ids, threads, allocations.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>
#include <set>

#include "core/linear/block_system.hpp"
#include "core/math/error.hpp"
#include "tests/linear/counting_new.hpp"
#include "tests/linear/systems.hpp"
#include "tests/oracle/dense.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::block_system_test {
namespace {

/// Random stencils with symmetric local Hessians and local gradients.
struct Family {
  int width = 0;
  std::vector<int> vertices;
  std::vector<double> hess, grad;
  Stencils stencils() const { return {width, vertices}; }
};

Family random_family(int width, int size, int n_vertices, unsigned seed, bool with_gaps = false) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Family f{.width = width, .vertices = {}, .hess = {}, .grad = {}};
  for (int e = 0; e < size; ++e) {
    std::set<int> chosen;
    while (static_cast<int>(chosen.size()) < width) {
      chosen.insert(static_cast<int>(random() % static_cast<unsigned>(n_vertices)));
    }
    std::vector<int> local(chosen.begin(), chosen.end());
    std::shuffle(local.begin(), local.end(), random);
    if (with_gaps && e % 3 == 0) local[static_cast<std::size_t>(width) - 1] = -1;
    f.vertices.insert(f.vertices.end(), local.begin(), local.end());
    Eigen::MatrixXd h = Eigen::MatrixXd::NullaryExpr(3 * width, 3 * width, [&] { return uniform(random); });
    h = (h + h.transpose()).eval();
    test::append_lower_blocks(h, f.hess);
    for (int k = 0; k < 3 * width; ++k) f.grad.push_back(uniform(random));
  }
  return f;
}

void add_dense(const Family& f, Eigen::MatrixXd& a, Positions& g) {
  const int w = f.width, ld = 3 * w;
  const std::size_t n_elements = f.stencils().size();
  for (std::size_t e = 0; e < n_elements; ++e) {
    const int* v = f.vertices.data() + e * static_cast<std::size_t>(w);
    const Eigen::MatrixXd h = test::from_lower_blocks(f.hess.data() + e * (f.hess.size() / n_elements), w);
    for (int i = 0; i < w; ++i) {
      if (v[i] < 0) continue;
      g.col(v[i]) += Eigen::Map<const Vec3d>(f.grad.data() + e * static_cast<std::size_t>(ld) + 3 * i);
      for (int j = 0; j < w; ++j) {
        if (v[j] >= 0) a.block<3, 3>(3 * v[i], 3 * v[j]) += h.block<3, 3>(3 * i, 3 * j);
      }
    }
  }
}

/// Pins every seventh vertex and locks z of every second one.
std::vector<std::uint8_t> some_fixed(int n) {
  std::vector<std::uint8_t> fixed(3 * static_cast<std::size_t>(n), 0);
  for (std::size_t v = 0; v < static_cast<std::size_t>(n); ++v) {
    if (v % 7 == 0) fixed[3 * v] = fixed[3 * v + 1] = fixed[3 * v + 2] = 1;
    if (v % 2 == 0) fixed[3 * v + 2] = 1;
  }
  return fixed;
}

Eigen::MatrixXd free_part(const Eigen::MatrixXd& a, const std::vector<std::uint8_t>& fixed) {
  std::vector<int> keep;
  for (int i = 0; i < a.rows(); ++i) {
    if (!fixed[static_cast<std::size_t>(i)]) keep.push_back(i);
  }
  const auto n = static_cast<Eigen::Index>(keep.size());
  Eigen::MatrixXd out(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      out(i, j) = a(keep[static_cast<std::size_t>(i)], keep[static_cast<std::size_t>(j)]);
  return out;
}

struct Assembled {
  Eigen::MatrixXd reduced;
  Positions gradient;
};

class BlockSystemTest : public ::testing::Test {
 protected:
  static constexpr int kN = 40;
  Family triangles = random_family(3, 60, kN, 1), hinges = random_family(4, 50, kN, 2),
         springs = random_family(2, 30, kN, 3, true);
  Family contacts = random_family(4, 25, kN, 4, true), pairs = random_family(2, 9, kN, 5);
  std::vector<double> diagonal = std::vector<double>(kN, 2.5);

  void set_elements(BlockSystem& s) {
    s.set_elements({triangles.stencils(), hinges.stencils(), springs.stencils()});
  }
  void assemble(BlockSystem& s) {
    s.clear();
    s.add_diagonal(diagonal);
    s.add_elements(0, triangles.hess);
    s.add_elements(1, hinges.hess);
    s.add_elements(2, springs.hess);
    s.add_contacts(0, contacts.hess);
    s.add_contacts(1, pairs.hess);
  }
  Eigen::MatrixXd expected(Positions& g) {
    Eigen::MatrixXd a = 2.5 * Eigen::MatrixXd::Identity(3 * kN, 3 * kN);
    g = Positions::Zero(3, kN);
    for (const Family* f : {&triangles, &hinges, &springs, &contacts, &pairs}) add_dense(*f, a, g);
    return a;
  }
};

TEST_F(BlockSystemTest, MeetsDenseAssemblyWithFixedDegreesOfFreedom) {
  const auto fixed = some_fixed(kN);
  BlockSystem s(kN, fixed);
  set_elements(s);
  s.set_contacts({contacts.stencils(), pairs.stencils()});
  assemble(s);
  Positions g_expected, g = Positions::Zero(3, kN);
  const Eigen::MatrixXd a = expected(g_expected), truth = free_part(a, fixed);
  const ReducedSystem& reduced = s.reduce(s.values());
  ASSERT_EQ(reduced.lower.rows(), truth.rows());
  ASSERT_EQ(s.n_free(), truth.rows());
  EXPECT_LT((dense(reduced) - truth).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_GT(truth.cwiseAbs().maxCoeff(), 1);
  EXPECT_EQ(reduced.block_start.back(), s.n_free());
  for (std::size_t b = 0; b + 1 < reduced.block_start.size(); ++b) {
    EXPECT_TRUE(reduced.block_start[b + 1] - reduced.block_start[b] >= 2);
  }
  for (std::size_t f = 0; f < 3; ++f) {
    const Family* families[] = {&triangles, &hinges, &springs};
    s.gather_elements(f, families[f]->grad, g);
  }
  s.gather_contacts(0, contacts.grad, g);
  s.gather_contacts(1, pairs.grad, g);
  EXPECT_LT((g - g_expected).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_GT(g.norm(), 1);

  const Positions v = test::unstacked<3, Eigen::Dynamic>(random_vector(3 * kN, 9));
  Positions y = Positions::Constant(3, kN, 0.5);
  s.multiply_add(s.values(), v, y);
  EXPECT_LT((test::stacked(y) - a * test::stacked(v) - VecXd::Constant(3 * kN, 0.5)).norm(), 1e-11);
}

TEST_F(BlockSystemTest, SubmatrixIsThatOfTheDenseMatrix) {
  BlockSystem s(kN, std::vector<std::uint8_t>(3 * kN, 0));
  set_elements(s);
  s.set_contacts({contacts.stencils(), pairs.stencils()});
  assemble(s);
  Positions g;
  const Eigen::MatrixXd a = expected(g);
  int unconnected = 0;
  for (const std::vector<int>& v : {std::vector<int>{7, 3, 21, 0}, {39, 2, 11}, {5, 4}, {12}}) {
    double out[144];
    std::fill(out, out + 144, -7.0);
    s.submatrix(s.values(), v.data(), static_cast<int>(v.size()), out);
    const Eigen::Map<const Eigen::Matrix<double, 12, 12>> m(out);
    for (std::size_t i = 0; i < v.size(); ++i) {
      for (std::size_t j = 0; j < v.size(); ++j) {
        const Mat3d block = m.block<3, 3>(3 * static_cast<int>(i), 3 * static_cast<int>(j));
        EXPECT_LT((block - a.block<3, 3>(3 * v[i], 3 * v[j])).norm(), 1e-13);
        unconnected += block.isZero(0);
      }
    }
  }
  EXPECT_GT(unconnected, 0);
  EXPECT_LT(unconnected, 20);
}

TEST_F(BlockSystemTest, ACopyOfTheElementBlocksOutlivesThePattern) {
  const int n = 40;
  BlockSystem s(n, std::vector<std::uint8_t>(3 * n, 0));
  const Family elements = random_family(3, 60, n, 4), first_rows = random_family(4, 12, n, 9),
               later_rows = random_family(4, 15, n, 10);
  s.set_elements({elements.stencils()});
  s.set_contacts({first_rows.stencils()});
  s.clear();
  s.add_elements(0, elements.hess);
  BlockSystem::Values copy;
  s.element_values(s.values(), copy);
  EXPECT_LT(copy.size(), s.values().size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  Positions g = Positions::Zero(3, n);
  add_dense(elements, a, g);
  ASSERT_TRUE(s.set_contacts({later_rows.stencils()}));
  int nonzero = 0;
  for (int k = 0; k + 4 <= n; ++k) {
    const int v[] = {k + 3, k, k + 2, k + 1};
    double out[144];
    s.element_submatrix(copy, v, 4, out);
    const Eigen::Map<const Eigen::Matrix<double, 12, 12>> m(out);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        const Mat3d block = m.block<3, 3>(3 * i, 3 * j);
        EXPECT_LT((block - a.block<3, 3>(3 * v[i], 3 * v[j])).norm(), 1e-13);
        nonzero += i != j && !block.isZero(0);
      }
    }
  }
  EXPECT_GT(nonzero, 10);
}

TEST_F(BlockSystemTest, VertexThatOccursTwiceInAStencilIsSummed) {
  BlockSystem s(3, std::vector<std::uint8_t>(9, 0));
  Family f = random_family(3, 2, 3, 8);
  f.vertices = {1, 0, 1, 2, 2, 0};
  s.set_elements({f.stencils()});
  s.add_elements(0, f.hess);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(9, 9);
  Positions g = Positions::Zero(3, 3);
  add_dense(f, a, g);
  EXPECT_LT((dense(s.reduce(s.values())) - a).norm(), 1e-13);
}

TEST_F(BlockSystemTest, PatternIdChangesExactlyWithThePattern) {
  BlockSystem s(kN, std::vector<std::uint8_t>(3 * kN, 0));
  set_elements(s);
  const std::uint64_t bare = s.reduce(s.values()).pattern_id;
  EXPECT_NE(bare, 0u);
  const auto id = [&] { return s.reduce(s.values()).pattern_id; };

  EXPECT_FALSE(s.set_contacts({}));
  Family inside{.width = 3,
                .vertices = {triangles.vertices.begin(), triangles.vertices.begin() + 6},
                .hess = {},
                .grad = {}};
  EXPECT_FALSE(s.set_contacts({inside.stencils()}));  // every block exists already
  EXPECT_EQ(id(), bare);
  EXPECT_TRUE(s.set_contacts({contacts.stencils()}));
  const std::uint64_t touching = id();
  EXPECT_NE(touching, bare);
  EXPECT_FALSE(s.set_contacts({contacts.stencils()}));  // the same stencils
  Family reversed = contacts;
  std::reverse(reversed.vertices.begin(), reversed.vertices.end());
  EXPECT_FALSE(s.set_contacts({reversed.stencils()}));  // other stencils, same blocks
  EXPECT_EQ(id(), touching);
  EXPECT_TRUE(s.set_contacts({contacts.stencils(), pairs.stencils()}));
  EXPECT_NE(id(), touching);
  EXPECT_TRUE(s.set_contacts({}));
  EXPECT_EQ(id(), bare);
}

TEST_F(BlockSystemTest, ChangingContactsMeetDenseAssemblyEveryTime) {
  const auto fixed = some_fixed(kN);
  BlockSystem s(kN, fixed);
  set_elements(s);
  for (unsigned round = 0; round < 12; ++round) {
    contacts = random_family(4, static_cast<int>(3 * round) % 20, kN, 100 + round, true);
    pairs = random_family(2, static_cast<int>(5 * round) % 11, kN, 200 + round / 2);
    s.set_contacts({contacts.stencils(), pairs.stencils()});
    assemble(s);
    Positions g;
    const Eigen::MatrixXd truth = free_part(expected(g), fixed);
    EXPECT_LT((dense(s.reduce(s.values())) - truth).cwiseAbs().maxCoeff(), 1e-13) << round;
  }
}

TEST_F(BlockSystemTest, ThreadsDoNotChangeABit) {
  const int n = 3000;
  const Family elements = random_family(4, 9000, n, 21), touching = random_family(4, 4000, n, 22);
  std::vector<Eigen::SparseMatrix<double>> matrices;
  std::vector<Positions> gradients;
  for (const std::size_t threads : {1u, 2u, 4u}) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    BlockSystem s(n, some_fixed(n));
    s.set_elements({elements.stencils()});
    s.set_contacts({touching.stencils()});
    s.add_elements(0, elements.hess);
    s.add_contacts(0, touching.hess);
    matrices.push_back(s.reduce(s.values()).lower);
    gradients.push_back(Positions::Zero(3, n));
    s.gather_elements(0, elements.grad, gradients.back());
  }
  for (std::size_t k = 1; k < 3; ++k) {
    ASSERT_EQ(matrices[k].nonZeros(), matrices[0].nonZeros());
    EXPECT_EQ(Eigen::VectorXd(matrices[k].coeffs()), Eigen::VectorXd(matrices[0].coeffs()));
    EXPECT_EQ(gradients[k], gradients[0]);
  }
  EXPECT_GT(matrices[0].norm(), 1);
}

TEST_F(BlockSystemTest, NothingIsAllocatedWhileThePatternStays) {
  BlockSystem s(kN, some_fixed(kN));
  set_elements(s);
  Family reversed = contacts;
  std::reverse(reversed.vertices.begin(), reversed.vertices.end());
  Positions g = Positions::Zero(3, kN);
  const auto iterate = [&](std::vector<Stencils> families) {
    s.set_contacts(std::move(families));
    assemble(s);
    s.gather_elements(1, hinges.grad, g);
    s.gather_contacts(0, contacts.grad, g);
    s.reduce(s.values());
  };
  iterate({contacts.stencils(), pairs.stencils()});
  iterate({reversed.stencils(), pairs.stencils()});
  std::vector<Stencils> same{reversed.stencils(), pairs.stencils()},
      other{contacts.stencils(), pairs.stencils()};
  const long before = n_allocations();
  iterate(std::move(same));
  iterate(std::move(other));  // other stencils, same pattern
  EXPECT_EQ(n_allocations() - before, 0);
  auto probe = std::make_unique<int>(1);
  EXPECT_EQ(n_allocations() - before, 1);  // the counter does count
}

TEST_F(BlockSystemTest, VectorsAreRestrictedAndExpanded) {
  const auto fixed = some_fixed(kN);
  BlockSystem s(kN, fixed);
  const Positions full = test::unstacked<3, Eigen::Dynamic>(random_vector(3 * kN, 3));
  VecXd reduced;
  s.restrict_vector(full, reduced);
  ASSERT_EQ(reduced.size(), s.n_free());
  Positions back = Positions::Constant(3, kN, 9.0);
  s.expand_vector(reduced, back);
  for (int i = 0; i < 3 * kN; ++i) {
    EXPECT_EQ(back.data()[i], fixed[static_cast<std::size_t>(i)] ? 9.0 : full.data()[i]);
  }
}

TEST_F(BlockSystemTest, BadInputIsAConfigError) {
  EXPECT_THROW(BlockSystem(3, std::vector<std::uint8_t>(8, 0)), ConfigError);
  BlockSystem s(kN, some_fixed(kN));
  const std::vector<int> outside = {0, kN};
  EXPECT_THROW(s.set_elements({Stencils{2, outside}}), ConfigError);
  set_elements(s);
  const std::vector<double> three(3);
  EXPECT_THROW(s.add_elements(0, three), ConfigError);
  EXPECT_THROW(s.add_elements(3, triangles.hess), ConfigError);
  EXPECT_THROW(s.add_contacts(0, contacts.hess), ConfigError);
}

}  // namespace
}  // namespace bb::block_system_test
