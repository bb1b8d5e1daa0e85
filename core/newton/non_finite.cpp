// Where numbers that are no numbers began: for the message of a step that ended with them.
#include <algorithm>
#include <cmath>

#include "core/newton/newton_system.hpp"

namespace bb {
namespace {

std::string vertex_name(const Scene& scene, int v) {
  const Body& body = scene.bodies[static_cast<std::size_t>(scene.body[static_cast<std::size_t>(v)])];
  return body.name + "[" + std::to_string(v - body.first_vertex) + "]";
}

/// Whether any of the numbers of element e, of which `list` has n for all, is not finite.
bool broken(const std::vector<double>& list, std::size_t e, std::size_t n) {
  const std::size_t width = n == 0 ? 0 : list.size() / n;
  const auto begin = list.begin() + static_cast<std::ptrdiff_t>(width * e);
  return std::any_of(begin, begin + static_cast<std::ptrdiff_t>(width),
                     [](double value) { return !std::isfinite(value); });
}

/// The first element of a family with such a number, -1 without one.
int broken_element(const TermFamily& family) {
  const std::size_t n = family.stencils.size();
  for (std::size_t e = 0; e < n; ++e) {
    for (const std::vector<double>* list : {&family.local.energy, &family.local.grad, &family.local.hess}) {
      if (broken(*list, e, n)) return static_cast<int>(e);
    }
  }
  return -1;
}

std::string element_name(const Scene& scene, const Stencils& stencils, int element) {
  std::string out;
  const auto width = static_cast<std::size_t>(stencils.width);
  for (const int v : stencils.vertices.subspan(width * static_cast<std::size_t>(element), width)) {
    if (v >= 0) out += (out.empty() ? "" : ", ") + vertex_name(scene, v);
  }
  return out;
}

/// The first vertex of which a column is not finite, -1 without one.
int broken_vertex(const Positions& columns) {
  for (Eigen::Index v = 0; v < columns.cols(); ++v) {
    if (!columns.col(v).allFinite()) return static_cast<int>(v);
  }
  return -1;
}

}  // namespace

std::string NewtonSystem::describe_non_finite(const Positions& dx) const {
  for (const auto& term : terms_) {
    for (const TermFamily& family : term->families()) {
      const int element = broken_element(family);
      if (element < 0) continue;
      return "element " + std::to_string(element) + " of term " + std::string(term->name()) + " (" +
             element_name(scene_, family.stencils, element) + ")";
    }
  }
  if (const int v = broken_vertex(gradient_); v >= 0) return "gradient at vertex " + vertex_name(scene_, v);
  if (const int v = broken_vertex(dx); v >= 0) return "direction at vertex " + vertex_name(scene_, v);
  return "a sum over all vertices";
}

}  // namespace bb
