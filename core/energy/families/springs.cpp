// Springs: their columns, rest lengths that move, and l - l0 = 0 as constraints.
#include "core/energy/families/springs.hpp"

#include <optional>

#include "core/energy/element_loop.hpp"
#include "core/energy/families/families.hpp"
#include "core/energy/families/family_of.hpp"
#include "core/energy/families/rest_lengths.hpp"

namespace bb {
namespace {

/// l - l0 = 0 of every spring, compliance 1/k in m/N.
class SpringConstraints final : public ConstraintBatch {
 public:
  /// rest_length [n] m and stiffness [n] N/m; vertices and rest_length outlive it.
  SpringConstraints(std::span<const int> vertices, std::span<const double> rest_length,
                    std::span<const double> stiffness)
      : vertices_(vertices), rest_length_(rest_length) {
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
  return spring_family(place, {"stitched vertices", "stitch stiffness", "stitch rest lengths"},
                       stitches.pairs, stitches.stiffness, stitches.rest_length);
}

}  // namespace bb
