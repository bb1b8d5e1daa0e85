// Membranes: the columns of their triangles, one family a model in use; rest shapes that move and creep.
#include "core/energy/families/membrane.hpp"

#include "core/energy/element_loop.hpp"
#include "core/energy/families/families.hpp"
#include "core/energy/families/family_of.hpp"
#include "core/energy/families/rest_memory.hpp"
#include "core/energy/membrane_model.hpp"
#include "core/energy/rest_shapes.hpp"

namespace bb {
namespace {

/// With what the part shrinks them by from the start.
std::vector<TriangleRest<double>> given_rests(const MembranePart& part, const PositionsView& x_rest,
                                              bool planar) {
  std::vector<TriangleRest<double>> rests = triangle_rests(part.triangles, x_rest, planar, part.warp);
  for (std::size_t e = 0; e < part.shrink.size(); ++e) {
    const Vec2d& factors = part.shrink[e];
    rests[e].dm_inv.col(0) /= factors[0];
    rests[e].dm_inv.col(1) /= factors[1];
    rests[e].area *= factors[0] * factors[1];
  }
  return rests;
}

template <class Elements>
class MembraneFamily final : public FamilyOf<Elements> {
  using Base = FamilyOf<Elements>;
  using Base::elements_, Base::place_;

 public:
  MembraneFamily(const FamilyPlace& place, const MembranePart& part,
                 std::span<const TriangleRest<double>> rests, bool planar, MovingRest rest)
      : Base(place, "membrane vertices", std::span(part.triangles)),
        part_(part),
        planar_(planar),
        rest_(std::move(rest)),
        given_(place.executor, "membrane rest shapes", rests),
        lame_(place.executor, "membrane Lame parameters"),
        crept_(place.executor, "membrane crept shapes"),
        creep_(place.executor, "membrane creep"),
        plastic_inv_(place.executor, "membrane plastic parts"),
        creeps_(!part.creep.empty()) {
    upload_pair(part.lame_mu, part.lame_lambda, lame_);
    elements_.rest = given_.rest();
    elements_.lame_mu = lame_.data();
    elements_.lame_lambda = lame_.data() + elements_.n;
    if (creeps_) {
      upload_pair(part.yield, part.creep, creep_);
      std::vector<double> none;
      for (std::size_t e = 0; e < rests.size(); ++e) none.insert(none.end(), {1, 0, 0, 1});
      plastic_inv_.set(none);
      crept_.copy_from(given_.numbers);
      elements_.rest = {crept_.data(), crept_.data() + 4 * elements_.n};
    }
    place_shapes(0);
  }

  void begin_step(const FamilyStep& step) override {
    plastic_inv_.begin_step();
    place_shapes(step.t_end);
  }
  void change_step(const FamilyStep& step) override { place_shapes(step.t_end); }
  bool flows() const override { return creeps_; }
  void end_step(const double* x, double dt) override {
    place_.executor.each(elements_.n, FlowTriangles{elements_, elements_.rest, creep_.data(),
                                                    creep_.data() + elements_.n, x, dt, plastic_inv_.flow()});
  }
  void keep(Archive& archive) override {
    if (creeps_) plastic_inv_.keep(archive);
  }

 private:
  void place_shapes(double t) {
    if (rest_.move(t)) given_.set(given_rests(part_, rest_.now(), planar_));
    if (!creeps_) return;
    place_.executor.each(
        elements_.n, PlaceTriangles{given_.numbers.data(), plastic_inv_.data(), elements_.n, crept_.data()});
  }

  const MembranePart& part_;
  const bool planar_;
  MovingRest rest_;
  RestShapes<TriangleRest<double>> given_;
  exec::Buffer<double> lame_;
  exec::Buffer<double> crept_;  // [5, n] rest shapes with their plastic parts; empty: those that are given
  exec::Buffer<double> creep_;  // [2, n] yield, rate
  RestMemory plastic_inv_;      // [4 n] inverses of plastic parts, triangle by triangle
  bool creeps_;
};

template <class Model>
MadeFamily of_model(const FamilyPlace& place, const MembranePart& part, const PositionsView& x_rest,
                    bool planar, MovingRest rest) {
  const std::vector<TriangleRest<double>> rests = given_rests(part, x_rest, planar);
  if (planar) {
    return std::make_unique<MembraneFamily<PlanarMembrane<Model>>>(place, part, rests, planar,
                                                                   std::move(rest));
  }
  return std::make_unique<MembraneFamily<SpaceMembrane<Model>>>(place, part, rests, planar, std::move(rest));
}

}  // namespace

MadeFamily membrane_family(const FamilyPlace& place, const MembranePart& part, const PositionsView& x_rest,
                           bool planar, MovingRest rest) {
  const std::size_t n = part.triangles.size();
  check_column("membrane/lame_mu", n, part.lame_mu, false);
  check_column("membrane/lame_lambda", n, part.lame_lambda, false);
  if (!part.creep.empty()) {
    check_column("membrane/yield", n, part.yield, false);
    check_column("membrane/creep", n, part.creep, false);
  }
  if (!part.shrink.empty() && part.shrink.size() != n) {
    throw ConfigError("membrane/shrink", std::to_string(part.shrink.size()) + " entries",
                      std::to_string(n) + ", one an element");
  }
  const std::string_view model = membrane_models<double>().require(part.model, "membrane/model").name;
#define ENTRY(id, ...) \
  if (model == #id) return of_model<membrane::id>(place, part, x_rest, planar, std::move(rest));
#include "core/energy/registry.inc"
#undef ENTRY
  return nullptr;  // require() has thrown
}

}  // namespace bb
