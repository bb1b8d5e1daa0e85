// The block matrix: patterns and maps live in block_pattern, gather_map and reduction; this file keeps them
// in step with the stencils.
#include "core/linear/block_system.hpp"

#include <algorithm>
#include <string>

#include "core/base/archive/archive.hpp"
#include "core/linear/block_pattern.hpp"
#include "core/linear/gather_map.hpp"
#include "core/linear/parallel.hpp"
#include "core/linear/reduction.hpp"
#include "core/math/at.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

using ConstBlock = Eigen::Map<const Mat3d>;

const GatherMap& family_of(const std::vector<GatherMap>& maps, std::size_t n, std::size_t family) {
  if (family >= n) throw ConfigError("BlockSystem family", std::to_string(family), "one that was set");
  return maps[family];
}

}  // namespace

struct BlockSystem::Data {
  Data(int n, const std::vector<std::uint8_t>& fixed)
      : n_vertices(n), reduction(n, fixed), element_pattern(diagonal_pattern(n)), pattern(element_pattern) {
    pattern_changed();
  }

  /// After `pattern` got another content.
  void pattern_changed() {
    values.assign(9 * pattern.row.size(), 0.0);
    for (GatherMap& map : elements) map.place(pattern);
    for (std::size_t f = 0; f < n_contact_families; ++f) contacts[f].place(pattern);
    reduction.build(pattern);
  }

  int n_vertices;
  Reduction reduction;
  std::vector<GatherMap> elements, contacts;  // contacts beyond n_contact_families only keep their buffers
  std::size_t n_contact_families = 0;
  BlockPattern element_pattern, pattern, spare, spare2;
  Values values;
};

BlockSystem::BlockSystem(int n_vertices, const std::vector<std::uint8_t>& fixed)
    : data_(std::make_unique<Data>(n_vertices, fixed)) {}
BlockSystem::~BlockSystem() = default;

void BlockSystem::set_elements(std::vector<Stencils> families) {
  Data& d = *data_;
  d.elements.resize(families.size());
  d.element_pattern = diagonal_pattern(d.n_vertices);
  for (std::size_t f = 0; f < families.size(); ++f) {
    d.elements[f].build(families[f], d.n_vertices);
    unite(d.element_pattern, d.elements[f].column_start(), d.elements[f].rows(), d.spare);
    std::swap(d.element_pattern, d.spare);
  }
  d.n_contact_families = 0;
  d.pattern = d.element_pattern;
  d.pattern_changed();
}

bool BlockSystem::set_contacts(std::vector<Stencils> families) {
  Data& d = *data_;
  bool same = families.size() == d.n_contact_families;
  for (std::size_t f = 0; same && f < families.size(); ++f) same = d.contacts[f].same(families[f]);
  if (same) return false;

  if (d.contacts.size() < families.size()) d.contacts.resize(families.size());
  const std::size_t n_known = d.n_contact_families;
  d.n_contact_families = families.size();
  BlockPattern *merged = &d.spare, *next = &d.spare2;
  merged->column_start = d.element_pattern.column_start;
  merged->row = d.element_pattern.row;
  for (std::size_t f = 0; f < families.size(); ++f) {
    GatherMap& map = d.contacts[f];
    if (f >= n_known || !map.same(families[f])) map.build(families[f], d.n_vertices);
    if (map.rows().empty()) continue;
    unite(*merged, map.column_start(), map.rows(), *next);
    std::swap(merged, next);
  }
  if (*merged == d.pattern) {
    for (std::size_t f = 0; f < families.size(); ++f) d.contacts[f].place(d.pattern);
    return false;
  }
  std::swap(d.pattern, *merged);
  d.pattern_changed();
  return true;
}

void BlockSystem::keep(Archive& archive) {
  std::vector<int> widths;
  std::vector<std::vector<int>> vertices;
  for (std::size_t f = 0; f < data_->n_contact_families; ++f) {
    const Stencils stencils = data_->contacts[f].stencils();
    widths.push_back(stencils.width);
    vertices.emplace_back(stencils.vertices.begin(), stencils.vertices.end());
  }
  archive(widths, vertices);
  if (!archive.reads()) return;
  std::vector<Stencils> families;
  for (std::size_t f = 0; f < widths.size(); ++f) families.push_back({widths[f], vertices[f]});
  set_contacts(families);
}

void BlockSystem::set_mesh(const PositionsView& x) { data_->reduction.set_mesh(data_->element_pattern, x); }

void BlockSystem::clear() {
  Values& values = data_->values;
  parallel_blocks(values.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    std::fill(values.data() + begin, values.data() + end, 0.0);
  });
}

void BlockSystem::take_values(Values& out) {
  out.resize(data_->values.size());
  out.swap(data_->values);
}

void BlockSystem::add_diagonal(std::span<const double> per_vertex) {
  Data& d = *data_;
  if (per_vertex.size() != at(d.n_vertices)) {
    throw ConfigError("BlockSystem diagonal", std::to_string(per_vertex.size()) + " numbers", "n_vertices");
  }
  for (int v = 0; v < d.n_vertices; ++v) {
    double* block = d.values.data() + 9 * at(d.pattern.column_start[at(v)]);
    for (int c = 0; c < 3; ++c) block[4 * c] += per_vertex[at(v)];
  }
}

void BlockSystem::add_elements(std::size_t family, const LocalHessians& hess) {
  family_of(data_->elements, data_->elements.size(), family).add_hessians(hess, data_->values);
}

void BlockSystem::add_contacts(std::size_t family, const LocalHessians& hess) {
  family_of(data_->contacts, data_->n_contact_families, family).add_hessians(hess, data_->values);
}

const BlockSystem::Values& BlockSystem::values() const { return data_->values; }

void BlockSystem::gather_elements(std::size_t family, std::span<const double> grad, PositionsSpan g) const {
  family_of(data_->elements, data_->elements.size(), family).add_gradients(grad, g);
}

void BlockSystem::gather_contacts(std::size_t family, std::span<const double> grad, PositionsSpan g) const {
  family_of(data_->contacts, data_->n_contact_families, family).add_gradients(grad, g);
}

namespace {

void submatrix_of(const BlockPattern& pattern, const BlockSystem::Values& values, const int* vertices, int k,
                  double* out) {
  Eigen::Map<Mat<double, 12, 12>> result(out);
  for (int b = 0; b < k; ++b) {
    for (int a = b; a < k; ++a) {
      const int row = std::max(vertices[a], vertices[b]), column = std::min(vertices[a], vertices[b]);
      const int block = pattern.find(row, column);
      Mat3d value = Mat3d::Zero();
      if (block >= 0) value = ConstBlock(values.data() + 9 * at(block));
      if (vertices[a] < vertices[b]) value.transposeInPlace();
      result.block<3, 3>(3 * a, 3 * b) = value;
      result.block<3, 3>(3 * b, 3 * a) = value.transpose();
    }
  }
}

}  // namespace

void BlockSystem::submatrix(const Values& values, const int* vertices, int k, double* out) const {
  submatrix_of(data_->pattern, values, vertices, k, out);
}

void BlockSystem::element_values(const Values& values, Values& out) const {
  const BlockPattern &elements = data_->element_pattern, &all = data_->pattern;
  out.resize(9 * elements.row.size());
  for (int c = 0; c < data_->n_vertices; ++c) {
    std::size_t from = at(all.column_start[at(c)]);
    const std::size_t end = at(elements.column_start[at(c) + 1]);
    for (std::size_t b = at(elements.column_start[at(c)]); b < end; ++b, ++from) {
      while (all.row[from] != elements.row[b]) ++from;  // elements are part of all
      std::copy_n(values.data() + 9 * from, 9, out.data() + 9 * b);
    }
  }
}

void BlockSystem::element_submatrix(const Values& element_values, const int* vertices, int k,
                                    double* out) const {
  submatrix_of(data_->element_pattern, element_values, vertices, k, out);
}

void BlockSystem::multiply_add(const Values& values, const PositionsView& v, PositionsSpan y) const {
  const BlockPattern& pattern = data_->pattern;
  for (int c = 0; c < data_->n_vertices; ++c) {
    const int begin = pattern.column_start[at(c)], end = pattern.column_start[at(c) + 1];
    Vec3d sum = ConstBlock(values.data() + 9 * at(begin)) * v.col(c);
    for (int b = begin + 1; b < end; ++b) {
      const ConstBlock block(values.data() + 9 * at(b));
      const int r = pattern.row[at(b)];
      y.col(r) += block * v.col(c);
      sum += block.transpose() * v.col(r);
    }
    y.col(c) += sum;
  }
}

const ReducedSystem& BlockSystem::reduce(const Values& values) { return data_->reduction.fill(values); }
int BlockSystem::n_free() const { return data_->reduction.n_free(); }
void BlockSystem::restrict_vector(const PositionsView& full, VecXd& reduced) const {
  data_->reduction.restrict_vector(full, reduced);
}
void BlockSystem::expand_vector(const VecXd& reduced, PositionsSpan full) const {
  data_->reduction.expand_vector(reduced, full);
}

}  // namespace bb
