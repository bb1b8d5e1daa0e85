#include "core/terms/cusps.hpp"

#include "core/bodies/part.hpp"
#include "core/energy/spring_batch.hpp"

namespace bb {

void Cusps::add(std::string_view of, const EnergyBatch& batch, const PositionsView& x) {
  const auto w = static_cast<std::size_t>(batch.width());
  for (const std::size_t e : batch.cusps(x)) {
    if (count++ == 0) term = of, element = e, width = w;
    const auto own = batch.vertices().subspan(w * e, w);
    vertices.insert(vertices.end(), own.begin(), own.end());
  }
}

CuspSearch::CuspSearch(const Scene& scene, Precision precision) {
  for (const PartEntry& entry : part_entries()) {
    std::vector<std::unique_ptr<EnergyBatch>> made;
    entry.part.add_batches(scene, precision, made);
    for (auto& batch : made) batches_.push_back({entry.name, std::move(batch)});
  }
  const Stitches& stitches = scene.stitches;
  if (stitches.pairs.empty()) return;
  batches_.push_back({"stitch", std::make_unique<SpringBatch>(stitches.pairs, stitches.rest_length,
                                                              stitches.stiffness, precision)});
}

Cusps CuspSearch::find(const PositionsView& x) const {
  Cusps out;
  for (const Named& named : batches_) out.add(named.term, *named.batch, x);
  return out;
}

}  // namespace bb
