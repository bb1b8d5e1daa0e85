// Springs of cloth: their columns, rest lengths that move and creep.
#include "core/energy/families/cloth_springs.hpp"

#include "core/energy/element_loop.hpp"
#include "core/energy/families/families.hpp"
#include "core/energy/families/family_of.hpp"
#include "core/energy/families/rest_lengths.hpp"
#include "core/energy/families/rest_memory.hpp"

namespace bb {
namespace {

/// Remembers how many times as long as its rest length every spring rests.
class ClothSpringFamily final : public FamilyOf<ClothSprings> {
 public:
  ClothSpringFamily(const FamilyPlace& place, const ClothSpringPart& part, MovingRest rest)
      : FamilyOf(place, "cloth spring vertices", std::span(part.pairs)),
        lengths_(part.pairs, part.rest_length, std::move(rest)),
        law_(place.executor, "cloth spring stiffnesses"),
        given_(place.executor, "cloth spring lengths"),
        rest_(place.executor, "cloth spring rest lengths", elements_.n),
        creep_(place.executor, "cloth spring creep"),
        ratio_(place.executor, "cloth spring ratios"),
        creeps_(any_positive(part.creep)) {
    std::vector<double> law;
    for (const auto* column : {&part.tension, &part.tension_growing, &part.compression,
                               &part.compression_growing, &part.exponent, &part.softening}) {
      law.insert(law.end(), column->begin(), column->end());
    }
    law_.upload(law);
    given_.upload(lengths_.now());
    upload_pair(part.yield, part.creep, creep_);
    ratio_.set(std::vector<double>(part.pairs.size(), 1.0));
    elements_.law = law_.data();
    elements_.rest_length = rest_.data();
    place_lengths(0);
  }

  void begin_step(const FamilyStep& step) override {
    ratio_.begin_step();
    place_lengths(step.t_end);
  }
  void change_step(const FamilyStep& step) override { place_lengths(step.t_end); }
  bool flows() const override { return creeps_; }
  void end_step(const double* x, double dt) override {
    place_.executor.each(elements_.n, FlowClothSprings{elements_, given_.data(), creep_.data(),
                                                       creep_.data() + elements_.n, x, dt, ratio_.flow()});
  }
  void keep(Archive& archive) override {
    if (creeps_) ratio_.keep(archive);
  }

 private:
  void place_lengths(double t) {
    if (lengths_.move(t)) given_.upload(lengths_.now());
    place_.executor.each(elements_.n, PlaceClothSprings{given_.data(), ratio_.data(), rest_.data()});
  }

  RestLengths lengths_;
  exec::Buffer<double> law_, given_, rest_;
  exec::Buffer<double> creep_;  // [2, n] yield, rate
  RestMemory ratio_;
  bool creeps_;
};

}  // namespace

MadeFamily cloth_spring_family(const FamilyPlace& place, const ClothSpringPart& part, MovingRest rest) {
  const std::size_t n = part.pairs.size();
  check_column("cloth_springs/rest_length", n, part.rest_length, false);
  check_column("cloth_springs/tension", n, part.tension, false);
  check_column("cloth_springs/tension_growing", n, part.tension_growing, false);
  check_column("cloth_springs/compression", n, part.compression, false);
  check_column("cloth_springs/compression_growing", n, part.compression_growing, false);
  check_column("cloth_springs/exponent", n, part.exponent, false);
  check_column("cloth_springs/softening", n, part.softening, false);
  check_column("cloth_springs/yield", n, part.yield, false);
  check_column("cloth_springs/creep", n, part.creep, false);
  return std::make_unique<ClothSpringFamily>(place, part, std::move(rest));
}

}  // namespace bb
