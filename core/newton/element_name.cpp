// Where NaN or infinite numbers began: for the message of a step that ended with them.
#include "core/newton/element_name.hpp"

#include <algorithm>
#include <cmath>

namespace bb {

std::string vertex_name(const Scene& scene, int vertex) {
  const Body& body = scene.bodies[static_cast<std::size_t>(scene.body[static_cast<std::size_t>(vertex)])];
  return body.name + "[" + std::to_string(vertex - body.first_vertex) + "]";
}

namespace {

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

}  // namespace

std::string element_name(const Scene& scene, std::string_view term, std::size_t element,
                         std::span<const int> vertices) {
  std::string out;
  for (const int v : vertices) {
    if (v >= 0) out += (out.empty() ? "" : ", ") + vertex_name(scene, v);
  }
  return "element " + std::to_string(element) + " of term " + std::string(term) + " (" + out + ")";
}

std::string broken_element_name(const Scene& scene, const TermList& terms) {
  for (const auto& term : terms) {
    for (const TermFamily& family : term->families()) {
      const int element = broken_element(family);
      if (element < 0) continue;
      const auto e = static_cast<std::size_t>(element), w = static_cast<std::size_t>(family.stencils.width);
      return element_name(scene, term->name(), e, family.stencils.vertices.subspan(w * e, w));
    }
  }
  return {};
}

}  // namespace bb
