#include "core/resident/sums/vectors.hpp"

namespace bb::resident {

std::vector<FixedMask> fixed_bits(std::span<const std::uint8_t> fixed) {
  std::vector<FixedMask> out(fixed.size() / 3);
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    if (fixed[i] != 0) out[i / 3] = static_cast<FixedMask>(out[i / 3] | 1u << (i % 3));
  }
  return out;
}

VectorTools::VectorTools(exec::Executor& executor, std::span<const std::uint8_t> fixed,
                         std::span<const Pin> pins)
    : executor_(executor),
      fixed_(executor, "fixed degrees of freedom"),
      pin_vertex_(executor, "prescribed vertices"),
      pin_target_(executor, "prescribed positions", 3 * static_cast<Index>(pins.size())),
      sum_(executor),
      least_(executor),
      sizes_(executor) {
  fixed_.upload(fixed_bits(fixed));
  for (const Pin& pin : pins) pins_.push_back(pin.vertex);
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

Index VectorTools::first_short_pin(const Buffer<double>& x) {
  if (pins_.empty()) return -1;
  least_.clear();
  executor_.each(pin_vertex_.size(),
                 FirstShortPin{pin_vertex_.data(), pin_target_.data(), x.data(), least_.data()});
  return least_.first();
}

double VectorTools::free_max(const Buffer<double>& column) {
  least_.clear();
  least_.add(column.size(), FreeSize{column.data(), fixed_.data()});
  return least_.largest();
}

DirectionSizes VectorTools::sizes(const Buffer<double>& dx, const Buffer<double>& x,
                                  const Buffer<double>& body_size, double epsilon) {
  const RoundingSize within{dx.data(), x.data(), body_size.data(), fixed_.data(), epsilon, true};
  RoundingSize beyond = within;
  beyond.within = false;
  sizes_.clear();
  sizes_.add(0, dx.size(), FreeSize{dx.data(), fixed_.data()});
  sizes_.add(1, dx.size(), within);
  sizes_.add(2, dx.size(), beyond);
  sizes_.add(3, dx.size() / 3, ColumnNorms{dx.data()});
  const auto least = sizes_.get();
  return {least.largest(0), least.largest(1), least.largest(2), least.largest(3)};
}

double VectorTools::max(const Buffer<double>& column) {
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

}  // namespace bb::resident
