#include "core/contact/contact_forces.hpp"

#include <algorithm>

#include "core/contact/contact_terms.hpp"

namespace bb {
namespace {

/// All of a row but its forces.
template <class Table>
ContactForce without_force(const Table& rows, std::size_t r) {
  ContactForce out;
  out.term = "contact";
  out.key = rows.key(r);
  std::copy_n(&rows.stencil[4 * r], 4, out.vertex.begin());
  out.force.fill(Vec3d::Zero());
  if (!rows.share.empty()) out.area = rows.share[r];
  return out;
}

}  // namespace

double work_of(const ContactForce& row, const PositionsView& x, const PositionsView& x_n) {
  double work = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (row.vertex[k] >= 0) work += row.force[k].dot(x.col(row.vertex[k]) - x_n.col(row.vertex[k]));
  }
  return work;
}

void add_forces(const ContactTable& rows, const PositionsView& x, const PositionsView& x_n,
                std::vector<ContactForce>& out) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    ContactForce row = without_force(rows, r);
    row.normal = -rows.force(r);
    const Eigen::Map<const Vec3d> normal(&rows.normal[3 * r]);
    for (std::size_t k = 0; k < 4; ++k) {
      if (row.vertex[k] >= 0) row.force[k] = (row.normal * rows.stencil_weight[4 * r + k]) * normal;
    }
    row.work = work_of(row, x, x_n);
    out.push_back(row);
  }
}

void add_forces(const MollifiedTable& rows, const PositionsView& x, const PositionsView& x_n,
                std::vector<ContactForce>& out) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    ContactForce row = without_force(rows, r);
    row.normal = -mollifier_of(rows, r, x) * rows.force(r);
    const Vec<double, 12> gradient = mollified_gradient(rows, r, x);
    const std::size_t points = rows.of_axis(r) ? 2 : 4;
    for (std::size_t k = 0; k < points; ++k) {
      row.force[k] = -gradient.segment<3>(3 * static_cast<Eigen::Index>(k));
    }
    // An axis that moves is there as a vertex, which takes what the edge does not.
    if (points == 2 && row.vertex[2] >= 0) row.force[2] = -(row.force[0] + row.force[1]);
    row.work = work_of(row, x, x_n);
    out.push_back(row);
  }
}

}  // namespace bb
