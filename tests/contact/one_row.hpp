// Rows that were merged into one.
#pragma once

#include <gtest/gtest.h>

#include "tests/contact/contact_scenes.hpp"

namespace bb::test {

/// One row without mollifier, of this kind, in which so many pairs meet at d (m).
inline void expect_one_row(const Rows& rows, ContactKind kind, double multiplicity, double d) {
  ASSERT_EQ(rows.table.size(), 1U);
  EXPECT_EQ(rows.table.kind[0], kind);
  EXPECT_EQ(rows.table.multiplicity[0], multiplicity);
  EXPECT_NEAR(rows.table.d[0], d, 1e-15);
}

}  // namespace bb::test
