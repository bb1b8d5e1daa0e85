// The contacts of one state as other terms read them: which points press on each other, in which direction, how hard.
#pragma once

#include <vector>

#include "core/contact/contact_table.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Rows of surfaces and of obstacles alike.
struct ContactLoads {
  std::vector<int> stencil;    // [4 n] all vertices, prescribed ones too, first primitive first, -1 padded
  std::vector<double> weight;  // [4 n] w_i, 0 padded: a motion dx opens the gap by sum w_i n . dx_i
  std::vector<double> normal;  // [3 n] unit
  std::vector<PairId> pair;    // [n]
  std::vector<double> load;    // [n] N, kappa |b'|; of mollified rows e times that

  std::size_t size() const { return load.size(); }
};

/// Append the rows of a table in their order, with the loads of the kappa and b' that it has. x: the state of the rows, in which
/// the mollifier is taken. Cost O(rows).
void add_loads(const ContactTable& rows, ContactLoads& out);
void add_loads(const MollifiedTable& rows, const PositionsView& x, ContactLoads& out);

}  // namespace bb
