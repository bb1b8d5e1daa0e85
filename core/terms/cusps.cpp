#include "core/terms/cusps.hpp"

#include "core/energy/families/families.hpp"
#include "core/model/bodies/part.hpp"

namespace bb {

void Cusps::add(std::string_view of, const ElementFamily& family, const PositionsView& x) {
  const auto w = static_cast<std::size_t>(family.width());
  for (const std::size_t e : family.cusps(x.data())) {
    if (count++ == 0) term = of, element = e, width = w;
    const auto own = family.vertices().subspan(w * e, w);
    vertices.insert(vertices.end(), own.begin(), own.end());
  }
}

CuspSearch::CuspSearch(const Scene& scene, Precision precision) {
  const FamilyPlace place{executor_, precision};
  for (const PartEntry& entry : part_entries()) {
    std::vector<std::unique_ptr<ElementFamily>> made;
    entry.part.add_families(scene, place, made);
    for (auto& family : made) families_.push_back({entry.name, std::move(family)});
  }
  if (!scene.stitches.pairs.empty()) families_.push_back({"stitch", stitch_family(place, scene.stitches)});
}

Cusps CuspSearch::find(const PositionsView& x, double t_end) const {
  Cusps out;
  for (const Named& named : families_) {
    named.family->change_step({.t_end = t_end});
    out.add(named.term, *named.family, x);
  }
  return out;
}

}  // namespace bb
