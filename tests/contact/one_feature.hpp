// Rows of pairs that have the same closest feature.
#pragma once

#include <gtest/gtest.h>

#include "tests/contact/contact_scenes.hpp"

namespace bb::test {

/// So many rows without mollifier and no others: of this kind, on the same vertices, at d (m).
inline void expect_one_feature(const Rows& rows, ContactKind kind, std::size_t n, double d) {
  ASSERT_EQ(rows.table.size(), n);
  for (std::size_t r = 0; r < n; ++r) {
    EXPECT_EQ(rows.table.kind[r], kind);
    EXPECT_EQ(rows.table.key(r), rows.table.key(0));
    EXPECT_NEAR(rows.table.d[r], d, 1e-15);
  }
}

}  // namespace bb::test
