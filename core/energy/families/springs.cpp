// Springs: their columns, rest lengths that move, l - l0 = 0 as constraints, and stitches that break.
#include "core/energy/families/springs.hpp"

#include <algorithm>
#include <optional>

#include "core/energy/element_loop.hpp"
#include "core/energy/families/families.hpp"
#include "core/energy/families/family_of.hpp"
#include "core/energy/families/rest_lengths.hpp"
#include "core/energy/families/rest_memory.hpp"

namespace bb {
namespace {

/// l - l0 = 0 of every spring, compliance 1/k in m/N.
class SpringConstraints final : public ConstraintBatch {
 public:
  /// rest_length [n] m and stiffness [n] N/m; vertices and rest_length outlive it.
  SpringConstraints(std::span<const int> vertices, std::span<const double> rest_length,
                    std::span<const double> stiffness)
      : vertices_(vertices), rest_length_(rest_length) {
    set(stiffness);
  }
  /// 0: there is no constraint.
  void set(std::span<const double> stiffness) {
    compliance_.clear();
    for (const double k : stiffness) compliance_.push_back(1 / k);
  }
  std::string_view name() const override { return "spring"; }
  ConstraintKind kind() const override { return ConstraintKind::equality; }
  std::string_view unit() const override { return "m"; }
  int width() const override { return 2; }
  std::span<const int> vertices() const override { return vertices_; }
  std::span<const double> compliance() const override { return compliance_; }
  double value(std::size_t e, const PositionsView& x, double* gradient) const override {
    const Points<2> p(x, vertices_, e);
    Vec3d of[2];
    const double out = spring_stretch<double>(p.x, rest_length_[e], of);
    for (std::size_t i = 0; i < 2; ++i) Vec3d::Map(gradient + 3 * i) = of[i];
    return out;
  }

 private:
  std::span<const int> vertices_;
  std::span<const double> rest_length_;
  std::vector<double> compliance_;
};

class SpringFamily final : public FamilyOf<Springs> {
 public:
  SpringFamily(const FamilyPlace& place, const SpringNames& names, std::span<const std::array<int, 2>> pairs,
               std::span<const double> stiffness, std::vector<double> rest_length, MovingRest rest)
      : FamilyOf(place, names.vertices, pairs),
        stiffness_(place.executor, names.stiffness),
        rest_length_(place.executor, names.rest_length),
        lengths_(pairs, std::move(rest_length), std::move(rest)),
        constraints_(vertices(), lengths_.now(), stiffness) {
    stiffness_.upload(stiffness);
    rest_length_.upload(lengths_.now());
    elements_.stiffness = stiffness_.data();
    elements_.rest_length = rest_length_.data();
  }
  void change_step(const FamilyStep& step) override {
    if (lengths_.move(step.t_end)) rest_length_.upload(lengths_.now());
  }
  const ConstraintBatch* constraints() const override { return &constraints_; }

 private:
  exec::Buffer<double> stiffness_, rest_length_;
  RestLengths lengths_;
  SpringConstraints constraints_;
};

/// Springs that break: what they remember is their stiffness, 0 once they are broken.
class BreakableSprings final : public FamilyOf<Springs> {
 public:
  BreakableSprings(const FamilyPlace& place, const SpringNames& names, const Stitches& stitches)
      : FamilyOf(place, names.vertices, std::span(stitches.pairs)),
        rest_length_(place.executor, names.rest_length),
        strength_(place.executor, "stitch strength"),
        broken_(place.executor, "stitch stiffness once a step is over"),
        stiffness_(place.executor, names.stiffness),
        constraints_(vertices(), stitches.rest_length, stitches.stiffness) {
    rest_length_.upload(stitches.rest_length);
    strength_.upload(stitches.strength);
    stiffness_.set(stitches.stiffness);
    elements_.rest_length = rest_length_.data();
    take_stiffness();
  }
  void begin_step(const FamilyStep&) override {
    stiffness_.begin_step();
    take_stiffness();
  }
  bool flows() const override { return true; }
  void end_step(const double* x, double /*dt*/) override { break_at(x, stiffness_.flow()); }
  std::optional<std::size_t> broken(const double* x) override {
    stiffness_.copy_to(broken_);
    break_at(x, broken_.data());
    const std::vector<double> left = broken_.download();
    return static_cast<std::size_t>(std::count(left.begin(), left.end(), 0.0));
  }
  void keep(Archive& archive) override {
    stiffness_.keep(archive);
    take_stiffness();
  }
  const ConstraintBatch* constraints() const override {
    if (!constraints_hold_) constraints_.set(stiffness_.values());
    constraints_hold_ = true;
    return &constraints_;
  }

 private:
  void take_stiffness() {
    elements_.stiffness = stiffness_.data();
    constraints_hold_ = false;
  }
  void break_at(const double* x, double* stiffness) {
    place_.executor.each(elements_.n, BreakSprings{elements_, strength_.data(), x, stiffness});
  }

  exec::Buffer<double> rest_length_, strength_, broken_;
  RestMemory stiffness_;
  mutable SpringConstraints constraints_;  // of stiffness_, where constraints_hold_
  mutable bool constraints_hold_ = false;
};

}  // namespace

std::vector<double> lengths_of(std::span<const std::array<int, 2>> pairs, const PositionsView& x) {
  std::vector<double> out;
  for (const auto& [a, b] : pairs) out.push_back((x.col(b) - x.col(a)).norm());
  return out;
}

MadeFamily spring_family(const FamilyPlace& place, const SpringNames& names,
                         std::span<const std::array<int, 2>> pairs, std::span<const double> stiffness,
                         std::vector<double> rest_length, MovingRest rest) {
  check_column("spring/stiffness", pairs.size(), stiffness, false);
  check_column("spring/rest_length", pairs.size(), rest_length, false);
  return std::make_unique<SpringFamily>(place, names, pairs, stiffness, std::move(rest_length),
                                        std::move(rest));
}

MadeFamily stitch_family(const FamilyPlace& place, const Stitches& stitches) {
  const SpringNames names{"stitched vertices", "stitch stiffness", "stitch rest lengths"};
  if (!stitches.first_breakable())
    return spring_family(place, names, stitches.pairs, stitches.stiffness, stitches.rest_length);
  check_column("stitches/stiffness", stitches.pairs.size(), stitches.stiffness, false);
  check_column("stitches/rest_length", stitches.pairs.size(), stitches.rest_length, false);
  check_column("stitches/strength", stitches.pairs.size(), stitches.strength, false);
  return std::make_unique<BreakableSprings>(place, names, stitches);
}

}  // namespace bb
