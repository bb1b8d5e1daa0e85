#include "core/contact/contact_row.hpp"

#include <algorithm>
#include <tuple>

namespace bb {

bool row_less(const ContactRow& a, const ContactRow& b) {
  return std::tie(a.key, a.kind, a.stencil, a.d_hat, a.offset) <
         std::tie(b.key, b.kind, b.stencil, b.d_hat, b.offset);
}

ContactKey contact_key(const std::array<int, 4>& stencil) {
  ContactKey key = stencil;
  std::sort(key.begin(), key.end());
  return key;
}

std::array<int, 4> feature_points(Region region) {
  switch (region) {
    case Region::p_p:
    case Region::p_e0:
    case Region::p_t0:
      return {0, 1, -1, -1};
    case Region::p_e1:
    case Region::p_t1:
    case Region::ea0_eb0:
      return {0, 2, -1, -1};
    case Region::p_t2:
    case Region::ea0_eb1:
      return {0, 3, -1, -1};
    case Region::ea1_eb0:
      return {1, 2, -1, -1};
    case Region::ea1_eb1:
      return {1, 3, -1, -1};
    case Region::p_e:
    case Region::p_e01:
      return {0, 1, 2, -1};
    case Region::p_e12:
    case Region::ea0_eb:
      return {0, 2, 3, -1};
    case Region::p_e20:
      return {0, 3, 1, -1};
    case Region::ea_eb0:
      return {2, 0, 1, -1};
    case Region::ea_eb1:
      return {3, 0, 1, -1};
    case Region::ea1_eb:
      return {1, 2, 3, -1};
    case Region::p_t:
    case Region::ea_eb:
      break;
  }
  return {0, 1, 2, 3};
}

template <class T>
ContactRow make_row(const int* vertex, const T* weights, const Vec<T, 3>& r, T distance, Region region,
                    const Side& law) {
  const std::array<int, 4> local = feature_points(region);
  ContactRow row;
  int n = 0;
  for (std::size_t k = 0; k < 4 && local[k] >= 0; ++k, ++n) {
    row.stencil[k] = vertex[local[k]];
    row.weight[k] = weights[local[k]];
  }
  T sign = row.weight[0] < 0 ? T(-1) : T(1);  // a vertex of the second edge against the first edge
  if (n == 2 && row.stencil[0] > row.stencil[1]) {
    std::swap(row.stencil[0], row.stencil[1]);
    std::swap(row.weight[0], row.weight[1]);
    sign = -sign;
  } else if (n == 3 && row.stencil[1] > row.stencil[2]) {
    std::swap(row.stencil[1], row.stencil[2]);
    std::swap(row.weight[1], row.weight[2]);
  }
  for (double& w : row.weight) w *= sign;
  const bool edges = region == Region::ea_eb;
  row.kind = n == 2   ? ContactKind::point_point
             : n == 3 ? ContactKind::point_edge
             : edges  ? ContactKind::edge_edge
                      : ContactKind::point_triangle;
  row.key = contact_key(row.stencil);
  row.normal = distance > 0 ? Vec3d((r * (sign / distance)).template cast<double>()) : Vec3d(Vec3d::Zero());
  row.d = distance - static_cast<T>(law.offset);
  row.d_hat = law.d_hat;
  row.offset = law.offset;
  return row;
}

template ContactRow make_row(const int*, const double*, const Vec<double, 3>&, double, Region, const Side&);
template ContactRow make_row(const int*, const float*, const Vec<float, 3>&, float, Region, const Side&);

}  // namespace bb
