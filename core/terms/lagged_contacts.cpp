#include "core/terms/lagged_contacts.hpp"

#include <algorithm>
#include <stdexcept>

namespace bb {
namespace {

/// The contacts that have a coefficient, in the order of their pairs: as an executor finds them.
std::vector<std::size_t> acting(const ContactLoads& contacts, const SideCoefficients& sides) {
  std::vector<std::size_t> out;
  for (std::size_t r = 0; r < contacts.size(); ++r) {
    if (sides.of(&contacts.stencil[4 * r], 1, contacts.pair[r]) != 0) out.push_back(r);
  }
  std::sort(out.begin(), out.end(),
            [&](std::size_t a, std::size_t b) { return contacts.pair[a] < contacts.pair[b]; });
  return out;
}

}  // namespace

LaggedContacts::LaggedContacts(std::string_view name, std::unique_ptr<LaggedFamily> family,
                               const TermList& before)
    : LaggedSteps(name, std::move(family)) {
  for (const auto& term : before) before_.push_back(term.get());
  families_.resize(1);
}

void LaggedContacts::adopt(const KnownStep& known) {
  for (const LaggedState& lagged : known.lagged) {
    if (lagged.term == name_) adopt(lagged);
  }
}

void LaggedContacts::adopt_from(const HostTerm& other) {
  const auto& same = static_cast<const LaggedContacts&>(other);
  contact_ = same.contact_;
  pairs_ = same.pairs_;
  adopt(same.family_->known(name_));
}

void LaggedContacts::adopt(const LaggedState& lagged) {
  family_->adopt(lagged);
  make_elements();
}

void LaggedContacts::linearise(const PositionsView& x, const TermContext&) {
  learn_loads();
  family_->derivatives(x.data(), families_[0].local);
}

void LaggedContacts::add_forces(const PositionsView& x, const PositionsView&,
                                std::vector<ContactForce>& out) const {
  if (!family_->loads_known()) return;
  const LaggedColumns& rows = family_->rows();
  const auto n = static_cast<std::size_t>(rows.size());
  std::vector<double> energy(n), gradient(3 * n), way(3 * n);
  family_->gradients(x.data(), energy.data(), gradient.data());
  family_->ways(x.data(), way.data());
  for (std::size_t e = 0; e < n; ++e) {
    const int* const vertex = rows.vertex.data() + e;
    const double* const weight = rows.weight.data() + e;
    const Vec3d on_motion = -Vec3d(gradient[e], gradient[n + e], gradient[2 * n + e]);
    const Vec3d normal(rows.normal.data()[e], rows.normal.data()[n + e], rows.normal.data()[2 * n + e]);
    ContactForce row;
    row.term = name_;
    row.key = key_of(rows.pair.data()[e], vertex, weight, n);
    for (std::size_t k = 0; k < 4; ++k) {
      row.vertex[k] = vertex[k * n];
      row.force[k] = row.vertex[k] >= 0 ? Vec3d(weight[k * n] * on_motion) : Vec3d::Zero();
    }
    row.normal = normal.dot(on_motion);
    row.tangential = slide_of<double>(on_motion, normal).norm();
    row.work = on_motion.dot(Vec3d::Map(&way[3 * e]));
    out.push_back(row);
  }
}

void LaggedContacts::take_rows(const PositionsView& x) {
  const ContactLoads contacts = contacts_at(x);
  contact_ = acting(contacts, family_->sides());
  pairs_ = contacts.pair;
  LaggedColumns& rows = family_->rows();
  const std::size_t n = contact_.size();
  rows.fit(static_cast<exec::Index>(n));
  for (std::size_t e = 0; e < n; ++e) {
    const std::size_t r = contact_[e];
    for (std::size_t k = 0; k < 4; ++k) {
      rows.vertex.data()[k * n + e] = contacts.stencil[4 * r + k];
      rows.weight.data()[k * n + e] = contacts.weight[4 * r + k];
    }
    for (std::size_t c = 0; c < 3; ++c) rows.normal.data()[c * n + e] = contacts.normal[3 * r + c];
    rows.pair.data()[e] = contacts.pair[r];
  }
  family_->take(x.data(), x.size());
  make_elements();
}

void LaggedContacts::learn_loads() {
  if (family_->loads_known()) return;
  const exec::Buffer<double>& lagged = family_->lagged();
  const ContactLoads now = contacts_at(PositionsView(lagged.data(), lagged.size() / 3));
  if (now.pair != pairs_)
    throw std::logic_error("the rows of a lagged contact state changed before their loads");
  double* const load = family_->rows().load.data();
  for (std::size_t e = 0; e < contact_.size(); ++e) load[e] = now.load[contact_[e]];
  family_->know_loads();
}

ContactLoads LaggedContacts::contacts_at(const PositionsView& x) const {
  ContactLoads out;
  for (const HostTerm* term : before_) term->add_loads(x, out);
  return out;
}

void LaggedContacts::make_elements() {
  const LaggedColumns& rows = family_->rows();
  const auto n = static_cast<std::size_t>(rows.size());
  vertices_.resize(4 * n);
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t e = 0; e < n; ++e) vertices_[4 * e + k] = rows.vertex.data()[k * n + e];
  }
  families_[0].stencils = {4, vertices_};
  families_[0].local.resize(n, 4);
  families_[0].trial_energy.resize(n);
}

void add_lagged(std::string_view name, MakeLagged make, const TermInputs& inputs, TermList& terms) {
  const FamilyPlace place{inputs.executor, inputs.options.precision};
  auto family = make(place, inputs.scene, inputs.options, inputs.scene.body.data());
  terms.add(std::make_unique<LaggedContacts>(name, std::move(family), terms));
}

}  // namespace bb
