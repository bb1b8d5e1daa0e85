// Rows on an executor against those of ContactSystem, pair by pair.
#pragma once

#include <gtest/gtest.h>

#include <map>

#include "tests/resident/contact_on_executor.hpp"

namespace bb::test {

struct Expected {
  std::uint8_t kind;
  std::array<int, 4> stencil;
  std::array<double, 4> weight;
  Vec3d normal;
  double d, d_hat;
  bool first;  // of its merged row: same bits
};

template <class Table>
Expected expected(const Table& t, std::size_t r, std::uint8_t kind, bool first) {
  Expected e{kind, {}, {}, Vec3d::Map(&t.normal[3 * r]), t.d[r], t.d_hat[r], first};
  std::copy_n(&t.stencil[4 * r], 4, e.stencil.begin());
  return e;
}

inline std::map<PairId, Expected> by_pair(const Rows& rows) {
  std::map<PairId, Expected> out;
  const ContactTable& t = rows.table;
  for (std::size_t r = 0; r < t.size(); ++r) {
    for (std::size_t i = t.pair_begin[r]; i < t.pair_begin[r + 1]; ++i) {
      Expected e = expected(t, r, static_cast<std::uint8_t>(t.kind[r]), i == t.pair_begin[r]);
      std::copy_n(&t.stencil_weight[4 * r], 4, e.weight.begin());
      out.emplace(t.pair[i], e);
    }
  }
  const MollifiedTable& m = rows.mollified;
  for (std::size_t r = 0; r < m.size(); ++r) {
    Expected e = expected(m, r, resident::mollified_kind, true);
    for (std::size_t k = 0, slot = 0; k < 4; ++k) {
      e.weight[k] = m.vertex[4 * r + k] < 0 ? 1e300 : m.weight[4 * r + slot++];  // of given ones not kept
    }
    out.emplace(m.pair[r], e);
  }
  return out;
}

inline void compare(const Scene& scene, resident::ResidentRows& rows, const Rows& reference,
                    std::array<int, 8>& n_kinds) {
  const std::map<PairId, Expected> pairs = by_pair(reference);
  const resident::RowView v = rows.view();
  ASSERT_EQ(static_cast<std::size_t>(v.n), pairs.size());
  EXPECT_EQ(rows.min_gap, reference.min_gap);
  const Surface surface(scene);
  Index r = 0;
  for (const auto& [pair, e] : pairs) {
    ASSERT_EQ(v.pair[r], pair);
    ASSERT_EQ(v.kind[r], e.kind);
    ++n_kinds[e.kind];
    const double tolerance = e.first ? 0 : 1e-11;
    EXPECT_NEAR(v.d[r], e.d, tolerance);
    EXPECT_EQ(v.d_hat[r], e.d_hat);
    EXPECT_LE((v.normal_of(r) - e.normal).norm(), tolerance * 1e3);
    for (int k = 0; k < 4; ++k) {
      ASSERT_EQ(v.vertex[k * v.n + r], e.stencil[at(k)]);
      if (e.weight[at(k)] != 1e300) {
        EXPECT_NEAR(v.weight[k * v.n + r], e.weight[at(k)], tolerance * 1e3);
      }
      const int vertex = e.stencil[at(k)];
      EXPECT_EQ(v.is_free(r, k), vertex >= 0 && surface.vertex_free[at(vertex)] != 0);
    }
    ++r;
  }
  EXPECT_EQ(static_cast<std::size_t>(rows.list.size()), reference.mollified.size());
}

}  // namespace bb::test
