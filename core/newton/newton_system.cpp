// Set-up, the state and its energies. The matrix and gradient are in newton_assembly.cpp.
#include "core/newton/newton_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/energy/hinge_batch.hpp"
#include "core/energy/membrane_batch.hpp"
#include "core/energy/spring_batch.hpp"

namespace bb {

namespace {

std::vector<std::uint8_t> fixed_dofs(const Scene& scene) {
  std::vector<std::uint8_t> fixed(3 * static_cast<std::size_t>(scene.n_vertices()), 0);
  for (const Pin& pin : scene.pins) {
    for (std::size_t k = 0; k < 3; ++k) fixed[3 * static_cast<std::size_t>(pin.vertex) + k] = 1;
  }
  if (scene.planar) {
    for (std::size_t i = 2; i < fixed.size(); i += 3) fixed[i] = 1;
  }
  return fixed;
}

}  // namespace

NewtonSystem::NewtonSystem(const Scene& scene, Method& method)
    : scene_(scene),
      method_(method),
      fixed_(fixed_dofs(scene)),
      contacts_(scene, method.contact_options),
      blocks_(std::make_unique<BlockSystem>(scene.n_vertices(), fixed_)),
      solver_(make_linear_solver(method.linear)),
      stiffness_(*method.stiffness, scene.mass) {
  min_d_hat_ = scene.d_hat.empty() ? 0 : *std::min_element(scene.d_hat.begin(), scene.d_hat.end());
  need_elastic_ = method.stiffness->needs_hessian() || method.keep_elastic_matrix ||
                  (!scene.limit.triangles.empty() && method.limit_stiffness.needs_hessian());
  build_elements();
}

void NewtonSystem::build_elements() {
  for (const MembranePart& membrane : scene_.membranes) {
    if (membrane.triangles.empty()) continue;
    elements_.push_back(std::make_unique<MembraneBatch>(membrane.model, membrane.triangles, scene_.rest,
                                                        membrane.lame_mu, membrane.lame_lambda, scene_.planar,
                                                        membrane.warp));
  }
  if (!scene_.springs.edges.empty()) {
    elements_.push_back(
        std::make_unique<SpringBatch>(scene_.springs.edges, scene_.rest, scene_.springs.stiffness));
  }
  if (!scene_.hinges.hinges.empty()) {
    elements_.push_back(std::make_unique<HingeBatch>(scene_.hinges.hinges, scene_.hinges.stiffness,
                                                     scene_.hinges.rest_angle));
  }
  if (!scene_.limit.triangles.empty()) {
    limit_ = std::make_unique<StrainLimitBatch>(scene_.limit.triangles, scene_.rest, scene_.limit.onset,
                                                scene_.limit.width, scene_.planar);
  }

  std::vector<Stencils> families;
  for (const auto& batch : elements_) families.push_back({batch->width(), batch->vertices()});
  if (limit_) families.push_back({3, limit_->vertices()});
  blocks_->set_elements(families);

  local_.resize(elements_.size());
  for (EnergyState* state : {&state_, &trial_}) {
    state->element.resize(elements_.size());
    for (std::size_t i = 0; i < elements_.size(); ++i) state->element[i].resize(elements_[i]->size());
    if (limit_) state->limit.resize(limit_->size());
  }
  if (limit_) limit_kappa_.resize(limit_->size());
}

void NewtonSystem::begin_step(const Positions& x_n, const Prediction& prediction, double dt,
                              double load_factor) {
  const ScopedPhase timer(clock_, Phase::prediction);
  terms_.x_n = x_n;
  terms_.force.resize(3, x_n.cols());
  for (Eigen::Index i = 0; i < x_n.cols(); ++i) {
    terms_.force.col(i) = (load_factor * scene_.mass[static_cast<std::size_t>(i)]) * scene_.gravity;
  }
  stiffness_.begin_step();
  restart_step(prediction, dt);
  limit_kappa_fresh_ = false;
  first_iterate_ = true;
  state_.x = x_n;
  trial_.x = x_n;
  sweep(x_n);
  const ScopedPhase rows(clock_, Phase::contact_rows);
  state_.gap_min = contacts_.find_rows(x_n, state_.rows, state_.mollified);
}

void NewtonSystem::restart_step(const Prediction& prediction, double dt) {
  const ScopedPhase timer(clock_, Phase::prediction);
  dt_ = dt;
  c_ = prediction.c;
  stiffness_.set_time(dt, c_);
  terms_.x_tilde = prediction.x_tilde;
  terms_.inertia.resize(scene_.mass.size());
  for (std::size_t i = 0; i < scene_.mass.size(); ++i) {
    terms_.inertia[i] = c_ == 0 ? 0 : scene_.mass[i] / (c_ * dt * dt);
  }
}

void NewtonSystem::evaluate_elements(EnergyState& state) const {
  for (std::size_t i = 0; i < elements_.size(); ++i) elements_[i]->values(state.x, state.element[i].data());
  if (limit_) {
    limit_->values(state.x, method_.limit, limit_kappa_.data(), state.limit.data());
    state.feasible = state.feasible && (method_.limit.literal || limit_->min_gap() > 0);
  }
}

void NewtonSystem::evaluate_shape(ContactTable& rows) const {
  method_.contact.eval(rows.size(), rows.d.data(), rows.d_hat.data(), rows.b.data(), rows.db.data(),
                       rows.d2b.data());
}

void NewtonSystem::evaluate_shape(MollifiedTable& rows) const {
  method_.contact.eval(rows.size(), rows.d.data(), rows.d_hat.data(), rows.b.data(), rows.db.data(),
                       rows.d2b.data());
}

void NewtonSystem::evaluate_contact_energies(EnergyState& state) const {
  contact_energies(state.rows, state.contact);
  mollified_energies(state.mollified, state.x, state.mollified_contact);
}

void NewtonSystem::sweep(const Positions& x1) {
  const ScopedPhase timer(clock_, Phase::broad_phase);
  if (contacts_.active()) contacts_.update_candidates(state_.x, x1);
}

StepBound NewtonSystem::contact_bound(const Positions& x1) const {
  const ScopedPhase timer(clock_, Phase::step_bound);
  return contacts_.active() ? contacts_.step_bound(state_.x, x1) : StepBound{};
}

double NewtonSystem::limit_bound(const Positions& dx) const {
  const ScopedPhase timer(clock_, Phase::strain_bound);
  return limit_ ? limit_->step_bound(state_.x, dx, 1.0, method_.contact_options.ccd_park) : 1.0;
}

std::optional<EnergyChange> NewtonSystem::try_state(const Positions& x) {
  {
    const ScopedPhase timer(clock_, Phase::contact_rows);
    trial_.x = x;
    trial_.feasible = true;
    trial_.gap_min = contacts_.find_rows(x, trial_.rows, trial_.mollified);
    const bool anywhere = method_.contact.literal && std::isfinite(trial_.x.sum());
    if (!(trial_.gap_min > 0) && !anywhere) return std::nullopt;
  }
  {
    const ScopedPhase timer(clock_, Phase::stiffness);
    stiffness_.freeze(trial_.rows, trial_.mollified, *blocks_, elastic_);
  }
  const ScopedPhase timer(clock_, Phase::line_search);
  evaluate_shape(trial_.rows);
  evaluate_shape(trial_.mollified);
  evaluate_contact_energies(trial_);
  evaluate_elements(trial_);
  if (!trial_.feasible) return std::nullopt;
  return energy_change(terms_, state_, trial_);
}

void NewtonSystem::accept() {
  const ScopedPhase timer(clock_, Phase::stiffness);
  std::swap(state_, trial_);
  stiffness_.keep(state_.rows, state_.mollified);
}

double NewtonSystem::grad_inf() const {
  double largest = 0;
  for (std::size_t i = 0; i < fixed_.size(); ++i) {
    if (!fixed_[i]) largest = std::max(largest, std::abs(gradient_.data()[i]));
  }
  return largest;
}

ContactCounts NewtonSystem::contact_counts() const {
  ContactCounts counts;
  for (const ContactKind kind : state_.rows.kind) {
    switch (kind) {
      case ContactKind::point_point:
        ++counts.point_point;
        break;
      case ContactKind::point_edge:
        ++counts.point_edge;
        break;
      case ContactKind::point_triangle:
        ++counts.point_triangle;
        break;
      case ContactKind::edge_edge:
        ++counts.edge_edge;
        break;
      case ContactKind::obstacle:
        ++counts.obstacle;
        break;
    }
  }
  counts.mollified = state_.mollified.size();
  return counts;
}

double NewtonSystem::max_stretch() const {
  if (!limit_) return 0;
  const ScopedPhase timer(clock_, Phase::strain_limit);
  limit_->measure(state_.x);
  return limit_->max_stretch();
}

double NewtonSystem::limit_gap_min_rel() const {
  if (!limit_) return 0;
  const ScopedPhase timer(clock_, Phase::strain_limit);
  limit_->measure(state_.x);
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < limit_->size(); ++e) {
    for (const double gap : limit_->gaps().subspan(2 * e, 2)) {
      smallest = std::min(smallest, gap / scene_.limit.width[e]);
    }
  }
  return smallest;
}

double NewtonSystem::limit_load_max() const {
  if (!limit_) return 0;
  const ScopedPhase timer(clock_, Phase::strain_limit);
  limit_->measure(state_.x);
  double largest = 0;
  for (std::size_t e = 0; e < limit_->size(); ++e) {
    const double width = scene_.limit.width[e];
    for (const double gap : limit_->gaps().subspan(2 * e, 2)) {
      if (gap >= width) continue;
      largest =
          std::max(largest, -limit_kappa_[e] * method_.limit.eval(gap, width).db / limit_->rests()[e].area);
    }
  }
  return largest;
}

}  // namespace bb
