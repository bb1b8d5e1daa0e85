#include "core/exec/sums/vectors.hpp"

#include <utility>

namespace bb::exec {

std::vector<FixedMask> fixed_bits(std::span<const std::uint8_t> fixed) {
  std::vector<FixedMask> out(fixed.size() / 3);
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    if (fixed[i] != 0) out[i / 3] = static_cast<FixedMask>(out[i / 3] | 1u << (i % 3));
  }
  return out;
}

VectorTools::VectorTools(Executor& executor, std::span<const std::uint8_t> fixed, std::vector<int> pins)
    : executor_(executor),
      fixed_(executor, "fixed degrees of freedom"),
      pins_(std::move(pins)),
      pin_vertex_(executor, "prescribed vertices"),
      pin_target_(executor, "prescribed positions", 3 * static_cast<Index>(pins_.size())),
      sum_(executor),
      least_(executor),
      short_pin_(executor),
      largest_(executor),
      sizes_(executor),
      products_(executor) {
  fixed_.upload(fixed_bits(fixed));
  pin_vertex_.upload(pins_);
}

void VectorTools::set_targets(const Positions& target) {
  std::vector<double> packed;
  for (const int v : pins_) packed.insert(packed.end(), target.col(v).data(), target.col(v).data() + 3);
  pin_target_.upload(packed);
}

void VectorTools::move(const Buffer<double>& x, const Buffer<double>& dx, double alpha,
                       Buffer<double>& trial) {
  trial.resize(x.size());
  executor_.each(x.size(), MoveAlong{x.data(), dx.data(), alpha, trial.data()});
}

void VectorTools::move_to_targets(const Buffer<double>& x, const Buffer<double>& dx, Buffer<double>& trial) {
  move(x, dx, 1, trial);
  executor_.each(pin_vertex_.size(), PlacePins{pin_vertex_.data(), pin_target_.data(), trial.data()});
}

void VectorTools::set_pin_motion(const Buffer<double>& x, Buffer<double>& dx) {
  executor_.each(pin_vertex_.size(), PinMotion{pin_vertex_.data(), pin_target_.data(), x.data(), dx.data()});
}

void VectorTools::look_at_pins(const Buffer<double>& x) {
  if (pins_.empty()) return;
  short_pin_.clear();
  executor_.each(pin_vertex_.size(),
                 FirstShortPin{pin_vertex_.data(), pin_target_.data(), x.data(), short_pin_.data()});
}

Index VectorTools::first_short_pin() const { return pins_.empty() ? -1 : short_pin_.first(); }

void VectorTools::look_at_largest(const Buffer<double>& column) {
  largest_.clear();
  largest_.add(column.size(), FreeSize{column.data(), fixed_.data()});
}

void VectorTools::take_solution(const Buffer<double>& step, const Buffer<double>& b, const Buffer<double>& g,
                                Buffer<double>& dx) {
  products_.clear();
  products_.add(dx.size(), TakeSolution{step.data(), b.data(), g.data(), fixed_.data(), dx.data()});
}

void VectorTools::look_at_direction(const Buffer<double>& dx, const Buffer<double>& x,
                                    const Buffer<double>& body_size, double epsilon) {
  sizes_.clear();
  sizes_.add(n_vertices(), DirectionParts{dx.data(), x.data(), body_size.data(), fixed_.data(), epsilon});
}

DirectionSizes VectorTools::direction_sizes() const {
  const DirectionKeys keys = sizes_.get();
  return {largest_of(keys.largest), largest_of(keys.within), largest_of(keys.beyond),
          largest_of(keys.vertex)};
}

double VectorTools::max(const PositionsView& column) {
  least_.clear();
  least_.add(column.size(), ColumnSize{column.data()});
  return least_.largest();
}

Compensated VectorTools::free_dot(const Buffer<double>& a, const Buffer<double>& b) {
  sum_.clear();
  sum_.add(a.size(), FreeDot{a.data(), b.data(), fixed_.data()});
  return sum_.get();
}

Index VectorTools::first_not_finite(const Buffer<double>& column) {
  least_.clear();
  executor_.each(column.size(), FirstNotFinite{column.data(), least_.data()});
  return least_.first();
}

void VectorTools::force_norms(const Buffer<double>& g, Buffer<double>& force) {
  force.resize(n_vertices());
  executor_.each(n_vertices(), ForceNorm{g.data(), fixed_.data(), force.data()});
}

}  // namespace bb::exec
