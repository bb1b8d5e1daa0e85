// What contacts do to their vertices at the end of a step, row by row: for frames and tables of forces.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "core/contact/contact_table.hpp"

namespace bb {

/// A row of the system that was solved last, as forces on its vertices.
struct ContactForce {
  std::string_view term;  // contact, friction or restitution: its line in the registry of terms
  ContactKey key{};
  std::array<int, 4> vertex{-1, -1, -1,
                            -1};  // prescribed ones and those of obstacles that move too, -1 padded
  std::array<Vec3d, 4> force;     // N, on each of them; 0 padded
  double normal = 0;              // N, pushes apart where it is > 0; below 0 in corrections of weights
  double tangential = 0;          // N, its length
  double work = 0;                // J, along the way of the step, done on both sides together
  std::optional<double> area;     // m^2, where weights by area give the row one
};

/// Appends the rows of a table in their order, with the kappa and b' that they have. x, x_n: end and start of the step
/// [3 x n] m; mollifiers are taken at x. Cost O(rows); of a mollified row that of its Hessian.
void add_forces(const ContactTable& rows, const PositionsView& x, const PositionsView& x_n,
                std::vector<ContactForce>& out);
void add_forces(const MollifiedTable& rows, const PositionsView& x, const PositionsView& x_n,
                std::vector<ContactForce>& out);

/// Sum of force times way over the vertices of the row, J.
double work_of(const ContactForce& row, const PositionsView& x, const PositionsView& x_n);

}  // namespace bb
