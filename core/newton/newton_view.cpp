#include "core/newton/newton_view.hpp"

#include <fmt/format.h>

#include "core/newton/element_name.hpp"
#include "core/newton/host_engine.hpp"
#include "core/newton/newton_system.hpp"

namespace bb {

void NewtonView::forget() {
  for (HostCopy* each : {&x_, &before_, &gradient_}) each->valid = false;
  state_.gradient_seen = false;
}

PositionsView NewtonView::host(const Column& column, HostCopy& to) const {
  if (state_.executor.in_host_memory()) return points(column);
  if (!to.valid) {
    to.values.resize(3, column.size() / 3);
    column.download({to.values.data(), static_cast<std::size_t>(to.values.size())});
    to.valid = true;
  }
  return to.values;
}

double NewtonView::grad_inf() const {
  if (!state_.gradient_seen) state_.vectors.look_at_largest(state_.g);
  state_.gradient_seen = true;
  return state_.vectors.free_largest();
}

void NewtonView::announce() const {
  state_.potential->announce(state_.x);
  state_.vectors.look_at_largest(state_.g);
  state_.gradient_seen = true;
}

void NewtonView::report_overload(bool with_direction, StepNumbers& out) const {
  if (!with_direction) state_.dx.fill_zero();
  system_.on_host().diagnosis().report_overload(out);
}

std::string NewtonView::describe_non_finite() const {
  if (std::string element = state_.potential->describe_non_finite(); !element.empty()) return element;
  const auto named = [this](const char* what, const Column& column) -> std::string {
    const exec::Index first = state_.vectors.first_not_finite(column);
    if (first < 0) return {};
    return fmt::format("{} at vertex {}", what, vertex_name(state_.scene, static_cast<int>(first / 3)));
  };
  if (std::string at = named("gradient", state_.g); !at.empty()) return at;
  if (std::string at = named("direction", state_.dx); !at.empty()) return at;
  return "a sum over all vertices";
}

}  // namespace bb
