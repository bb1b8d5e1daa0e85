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

template <class T>
ContactRow make_row(const int* vertex, const T* weights, const Vec<T, 3>& r, T distance, Region region,
                    const Side& law) {
  const PairRow pair = pair_row<T>(vertex, weights, r, distance, region, law.offset);
  ContactRow row;
  row.kind = pair.kind;
  std::copy_n(pair.stencil, 4, row.stencil.begin());
  std::copy_n(pair.weight, 4, row.weight.begin());
  row.key = contact_key(row.stencil);
  row.normal = pair.normal;
  row.d = pair.d;
  row.d_hat = law.d_hat;
  row.offset = law.offset;
  return row;
}

template ContactRow make_row(const int*, const double*, const Vec<double, 3>&, double, Region, const Side&);
template ContactRow make_row(const int*, const float*, const Vec<float, 3>&, float, Region, const Side&);

}  // namespace bb
