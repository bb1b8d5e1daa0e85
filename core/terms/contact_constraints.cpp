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
  find_before(rows.pair, mollified.pair);
}

// Both tables ascend, and no pair is in both.
void ContactConstraints::find_before(const std::vector<PairId>& rows, const std::vector<PairId>& mollified) {
  now_.clear();
  before_.assign(rows.size() + mollified.size(), -1);
  auto old = places_.begin();
  for (std::size_t a = 0, b = 0; a < rows.size() || b < mollified.size();) {
    const bool of_rows = b == mollified.size() || (a < rows.size() && rows[a] < mollified[b]);
    const Place place = of_rows ? Place{rows[a], a} : Place{mollified[b], rows.size() + b};
    ++(of_rows ? a : b);
    now_.push_back(place);
    while (old != places_.end() && old->pair < place.pair) ++old;
    if (old != places_.end() && old->pair == place.pair)
      before_[place.at] = static_cast<std::ptrdiff_t>(old->at);
  }
  places_.swap(now_);
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
