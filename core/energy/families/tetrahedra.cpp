// Tetrahedra: their columns, one family a model in use; rest shapes that move.
#include "core/energy/families/tetrahedra.hpp"

#include "core/energy/element_loop.hpp"
#include "core/energy/families/families.hpp"
#include "core/energy/families/family_of.hpp"
#include "core/energy/membrane_list.hpp"
#include "core/energy/rest_shapes.hpp"
#include "core/energy/solid_model.hpp"

namespace bb {
namespace {

template <class Model>
class TetrahedronFamily final : public FamilyOf<Tetrahedra<Model>> {
 public:
  TetrahedronFamily(const FamilyPlace& place, const SolidPart& part, const PositionsView& x_rest,
                    MovingRest rest)
      : FamilyOf<Tetrahedra<Model>>(place, "solid vertices", std::span(part.tetrahedra)),
        part_(part),
        rest_(std::move(rest)),
        shapes_(place.executor, "solid rest shapes", tetrahedron_rests(part.tetrahedra, x_rest)),
        lame_(place.executor, "solid Lame parameters") {
    upload_pair(part.lame_mu, part.lame_lambda, lame_);
    Tetrahedra<Model>& elements = this->elements_;
    elements.rest = shapes_.rest();
    elements.lame_mu = lame_.data();
    elements.lame_lambda = lame_.data() + elements.n;
    place_shapes(0);
  }
  void change_step(const FamilyStep& step) override { place_shapes(step.t_end); }

 private:
  void place_shapes(double t) {
    if (rest_.move(t)) shapes_.set(tetrahedron_rests(part_.tetrahedra, rest_.now()));
  }

  const SolidPart& part_;
  MovingRest rest_;
  RestShapes<TetrahedronRest<double>> shapes_;
  exec::Buffer<double> lame_;
};

}  // namespace

MadeFamily tetrahedron_family(const FamilyPlace& place, const SolidPart& part, const PositionsView& x_rest,
                              MovingRest rest) {
  check_column("solid/lame_mu", part.tetrahedra.size(), part.lame_mu, false);
  check_column("solid/lame_lambda", part.tetrahedra.size(), part.lame_lambda, false);
  const std::string_view model = solid_models<double>().require(part.model, "solid/model").name;
#define ENTRY(id, ...) \
  if (model == #id)    \
    return std::make_unique<TetrahedronFamily<solid::id>>(place, part, x_rest, std::move(rest));
#include "core/energy/solids.inc"
#undef ENTRY
  return nullptr;  // require() has thrown
}

}  // namespace bb
