// Rows on an executor against those of ContactSystem, pair by pair.
#pragma once

#include <gtest/gtest.h>

#include <map>

#include "tests/executor/contact_on_executor.hpp"

namespace bb::test {

/// Row r of one of the two tables.
struct Expected {
  std::uint8_t kind;
  std::array<int, 4> stencil;
  std::array<double, 4> weight;
  Vec3d normal;
  double d, d_hat;
};

template <class Table>
Expected expected(const Table& t, std::size_t r, std::uint8_t kind) {
  Expected e{kind, {}, {}, Vec3d::Map(&t.normal[3 * r]), t.d[r], t.d_hat[r]};
  std::copy_n(&t.stencil[4 * r], 4, e.stencil.begin());
  std::copy_n(&t.stencil_weight[4 * r], 4, e.weight.begin());
  return e;
}

inline std::map<PairId, Expected> by_pair(const Rows& rows) {
  std::map<PairId, Expected> out;
  const ContactTable& t = rows.table;
  for (std::size_t r = 0; r < t.size(); ++r)
    out.emplace(t.pair[r], expected(t, r, static_cast<std::uint8_t>(t.kind[r])));
  const MollifiedTable& m = rows.mollified;
  for (std::size_t r = 0; r < m.size(); ++r) out.emplace(m.pair[r], expected(m, r, mollified_kind));
  return out;
}

/// Bit for bit.
inline void compare(const Scene& scene, exec::ExecutorRows& rows, const Rows& reference,
                    std::array<int, 8>& n_kinds) {
  const std::map<PairId, Expected> pairs = by_pair(reference);
  const exec::RowView v = rows.view();
  ASSERT_EQ(static_cast<std::size_t>(v.n), pairs.size());
  EXPECT_EQ(rows.min_gap, reference.min_gap);
  const Surface surface(scene);
  Index r = 0;
  for (const auto& [pair, e] : pairs) {
    ASSERT_EQ(v.pair[r], pair);
    ASSERT_EQ(v.kind[r], e.kind);
    ++n_kinds[e.kind];
    EXPECT_EQ(v.d[r], e.d);
    EXPECT_EQ(v.d_hat[r], e.d_hat);
    EXPECT_EQ(v.normal_of(r), e.normal);
    for (int k = 0; k < 4; ++k) {
      ASSERT_EQ(v.vertex[k * v.n + r], e.stencil[at(k)]);
      EXPECT_EQ(v.weight[k * v.n + r], e.weight[at(k)]);
      const int vertex = e.stencil[at(k)];
      EXPECT_EQ(v.is_free(r, k), vertex >= 0 && surface.vertex_free[at(vertex)] != 0);
    }
    ++r;
  }
  EXPECT_EQ(static_cast<std::size_t>(rows.list.size()), reference.mollified.size());
}

}  // namespace bb::test
