#include "experiments/run/spectrum_ends.hpp"

#include <algorithm>
#include <span>

#include "core/contact/pair_name.hpp"
#include "core/math/lower_blocks.hpp"
#include "core/terms/contact.hpp"

namespace bb {
namespace {

/// u_e^T H_e u_e of an element on the vertices `vertex`, -1: none.
double element_energy(std::span<const int> vertex, const double* hess, const Positions& u) {
  double sum = 0;
  for (std::size_t b = 0; b < vertex.size(); ++b) {
    for (std::size_t a = b; a < vertex.size(); ++a, hess += 9) {
      if (vertex[a] < 0 || vertex[b] < 0) continue;
      const double part = u.col(vertex[a]).dot(Mat3d::Map(hess) * u.col(vertex[b]));
      sum += a == b ? part : 2 * part;
    }
  }
  return sum;
}

std::string element_name(const Diagnosis& system, const HostTerm& term, std::size_t family,
                         std::size_t element) {
  const Scene& scene = system.scene();
  if (term.group() == TermGroup::contact && family == 0) {
    const ContactTable& rows = contact_state(system.terms()).rows;
    return std::string(term.name()) + ": " + pair_name(scene, rows.key(element), rows.kind[element]);
  }
  std::string out(term.name());
  const Stencils& stencils = term.families()[family].stencils;
  const std::size_t width = static_cast<std::size_t>(stencils.width);
  const char* separator = ": ";
  for (const int id : stencils.vertices.subspan(width * element, width)) {
    if (id < 0) continue;
    const Body& body = scene.bodies[static_cast<std::size_t>(scene.body[static_cast<std::size_t>(id)])];
    out += separator + body.name + "[" + std::to_string(id - body.first_vertex) + "]";
    separator = ", ";
  }
  return out;
}

/// The parts of lambda: of each term, and of the element with the largest one.
void add_terms(Diagnosis& system, TermSet set, const Positions& u, SpectrumEnd& end) {
  double largest = 0, total = 0;
  const HostTerm* holder = nullptr;
  std::size_t holder_family = 0, holder_element = 0;
  system.visit_clamped(set, [&](const HostTerm& term, std::size_t family, std::span<const double> hess) {
    const Stencils& stencils = term.families()[family].stencils;
    const std::size_t width = static_cast<std::size_t>(stencils.width);
    double sum = 0;
    for (std::size_t e = 0; e < stencils.size(); ++e) {
      const double part = element_energy(stencils.vertices.subspan(width * e, width),
                                         hess.data() + n_lower_numbers(width) * e, u);
      sum += part;
      if (holder && part <= largest) continue;
      largest = part;
      holder = &term, holder_family = family, holder_element = e;
    }
    total += sum;
    const auto known = std::find_if(end.terms.begin(), end.terms.end(),
                                    [&](const TermShare& share) { return share.term == term.name(); });
    if (known != end.terms.end()) {
      known->share += sum;
    } else if (stencils.size() > 0) {
      end.terms.push_back({std::string(term.name()), sum});
    }
  });
  for (TermShare& share : end.terms) share.share /= total;
  std::stable_sort(end.terms.begin(), end.terms.end(),
                   [](const TermShare& a, const TermShare& b) { return a.share > b.share; });
  end.lambda = total;
  end.element_share = largest / total;
  if (holder) end.element = element_name(system, *holder, holder_family, holder_element);
}

/// The parts of |v|^2.
void add_vertices(const Scene& scene, const Positions& v, SpectrumEnd& end) {
  std::vector<double> of_body(scene.bodies.size(), 0.0);
  double fourth = 0, largest = 0;
  for (Eigen::Index i = 0; i < v.cols(); ++i) {
    const double part = v.col(i).squaredNorm();
    of_body[static_cast<std::size_t>(scene.body[static_cast<std::size_t>(i)])] += part;
    fourth += part * part;
    if (part <= largest) continue;
    largest = part;
    end.vertex = static_cast<int>(i);
  }
  const auto body = std::max_element(of_body.begin(), of_body.end());
  end.body = scene.bodies[static_cast<std::size_t>(body - of_body.begin())].name;
  end.body_share = *body;
  end.vertices = 1 / fourth;
}

}  // namespace

std::vector<SpectrumEnd> describe_ends(Diagnosis& system, TermSet set, const EndVectors& ends) {
  std::vector<SpectrumEnd> out;
  Positions full = Positions::Zero(3, system.x().cols());
  for (const SpectrumSide side : {SpectrumSide::smallest, SpectrumSide::largest}) {
    const EndVector& vector = side == SpectrumSide::smallest ? ends.smallest : ends.largest;
    SpectrumEnd end;
    end.side = side;
    system.blocks().expand_vector(vector.unscaled, full);
    add_terms(system, set, full, end);
    system.blocks().expand_vector(vector.vector, full);
    add_vertices(system.scene(), full, end);
    out.push_back(std::move(end));
  }
  return out;
}

}  // namespace bb
