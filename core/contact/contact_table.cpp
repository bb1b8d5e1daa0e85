#include "core/contact/contact_table.hpp"

namespace bb {

void ContactTable::resize(std::size_t n) {
  kind.resize(n);
  pair.resize(n);
  for (auto* column : {&stencil, &vertex}) column->resize(4 * n);
  for (auto* column : {&stencil_weight, &weight}) column->resize(4 * n);
  n_free.resize(n);
  parts.resize(n);
  for (auto* column : {&normal, &flat}) column->resize(3 * n);
  for (auto* column : {&d, &d_hat, &offset, &kappa, &kappa_before, &b, &db, &d2b, &curvature}) {
    column->resize(n);
  }
}

void MollifiedTable::resize(std::size_t n) {
  for (auto* column : {&stencil, &vertex, &free_vertex}) column->resize(4 * n);
  for (auto* column : {&stencil_weight, &weight}) column->resize(4 * n);
  n_free.resize(n);
  pair.resize(n);
  parts.resize(n);
  for (auto* column : {&normal, &axis, &axis_point}) column->resize(3 * n);
  for (auto* column : {&eps, &d, &d_hat, &offset, &kappa, &kappa_before, &b, &db, &d2b}) column->resize(n);
}

}  // namespace bb
