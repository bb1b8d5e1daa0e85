#include "core/contact/contact_loads.hpp"

#include "core/contact/contact_terms.hpp"

namespace bb {
namespace {

/// All of a row but its load.
template <class Table>
void add_row(const Table& rows, std::size_t r, ContactLoads& out) {
  const auto append = [r](const auto& from, std::size_t n, auto& to) {
    to.insert(to.end(), &from[n * r], &from[n * r] + n);
  };
  append(rows.stencil, 4, out.stencil);
  append(rows.stencil_weight, 4, out.weight);
  append(rows.normal, 3, out.normal);
  out.pair.push_back(rows.pair[r]);
}

}  // namespace

void add_loads(const ContactTable& rows, ContactLoads& out) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    add_row(rows, r, out);
    out.load.push_back(-rows.force(r));
  }
}

void add_loads(const MollifiedTable& rows, const PositionsView& x, ContactLoads& out) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    add_row(rows, r, out);
    const double e = mollifier_of(rows, r, x);
    out.load.push_back(-rows.kappa[r] * e * rows.db[r]);
  }
}

}  // namespace bb
