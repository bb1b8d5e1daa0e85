#include "core/terms/contact_constraints.hpp"

namespace bb {
template <class Table>
void ContactConstraints::add(const Table& rows, const PositionsView& x, bool compliant) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Vec3d normal = Vec3d::Map(&rows.normal[3 * r]);
    double level = rows.d[r];
    for (std::size_t k = 0; k < 4; ++k) {
      const int vertex = rows.stencil[4 * r + k];
      const double weight = vertex < 0 ? 0.0 : rows.stencil_weight[4 * r + k];
      vertices_.push_back(vertex);
      weight_.push_back(weight);
      if (vertex >= 0) level -= weight * normal.dot(x.col(vertex));
    }
    normal_.insert(normal_.end(), normal.data(), normal.data() + 3);
    level_.push_back(level);
    compliance_.push_back(compliant ? 1 / rows.kappa[r] : 0.0);
  }
}

void ContactConstraints::set(const ContactTable& rows, const MollifiedTable& mollified,
                             const PositionsView& x, bool compliant) {
  vertices_.clear(), weight_.clear(), normal_.clear(), level_.clear(), compliance_.clear(), before_.clear();
  add(rows, x, compliant);
  add(mollified, x, compliant);
  std::map<PairId, std::ptrdiff_t> now;
  const auto note = [&](const auto& table) {
    for (const PairId pair : table.pair) {
      const auto found = index_.find(pair);
      now[pair] = static_cast<std::ptrdiff_t>(before_.size());
      before_.push_back(found == index_.end() ? -1 : found->second);
    }
  };
  note(rows);
  note(mollified);
  index_ = std::move(now);
}

double ContactConstraints::value(std::size_t e, const PositionsView& x, double* gradient) const {
  const Vec3d normal = Vec3d::Map(&normal_[3 * e]);
  double gap = level_[e];
  for (std::size_t k = 0; k < 4; ++k) {
    const int vertex = vertices_[4 * e + k];
    Vec3d::Map(gradient + 3 * k) = weight_[4 * e + k] * normal;
    if (vertex >= 0) gap += weight_[4 * e + k] * normal.dot(x.col(vertex));
  }
  return gap;
}

}  // namespace bb
