#include "core/terms/lagged_family.hpp"

namespace bb {

LaggedColumns::LaggedColumns(exec::Executor& executor)
    : vertex(executor, "lagged vertices"),
      weight(executor, "lagged weights"),
      normal(executor, "lagged normals"),
      pair(executor, "lagged pairs"),
      load(executor, "lagged loads"),
      strength(executor, "lagged strengths") {}

void LaggedColumns::fit(exec::Index n) {
  vertex.fit(4 * n), weight.fit(4 * n), normal.fit(3 * n), pair.fit(n);
  for (auto* column : {&load, &strength}) {
    column->fit(n);
    column->fill_zero();
  }
}

LaggedFamily::LaggedFamily(const FamilyPlace& place, const int* body, CombineRule rule,
                           std::span<const double> of_body, std::span<const double> of_obstacle)
    : place_(place),
      rows_(place.executor),
      body_(body),
      rule_(rule),
      of_body_(place.executor, "coefficients of bodies"),
      of_obstacle_(place.executor, "coefficients of obstacles"),
      lagged_(place.executor, "lagged state") {
  of_body_.upload(of_body);
  of_obstacle_.upload(of_obstacle);
}

void LaggedFamily::take(const double* x, exec::Index n_numbers) {
  lagged_.resize(n_numbers);
  place_.executor.copy(lagged_.data(), x, static_cast<std::size_t>(n_numbers) * sizeof(double));
  loads_known_ = false;
  rows_changed();
}

void LaggedFamily::know_loads() {
  place_.executor.each(size(), RowStrengths{view(), sides(), rows_.pair.data(), rows_.strength.data()});
  strengthen();
  loads_known_ = true;
}

LaggedState LaggedFamily::known(std::string_view term) const {
  LaggedState out;
  out.term = term;
  out.lagged = lagged_.download();
  out.vertex = rows_.vertex.download(), out.weight = rows_.weight.download();
  out.normal = rows_.normal.download(), out.pair = rows_.pair.download();
  out.load = rows_.load.download(), out.strength = rows_.strength.download();
  out.loads_known = loads_known_;
  out.kept = kept();
  return out;
}

void LaggedFamily::adopt(const LaggedState& known) {
  lagged_.upload(known.lagged);
  rows_.vertex.upload(known.vertex), rows_.weight.upload(known.weight), rows_.normal.upload(known.normal);
  rows_.pair.upload(known.pair), rows_.load.upload(known.load), rows_.strength.upload(known.strength);
  loads_known_ = known.loads_known;
  adopt_kept(known);
  rows_changed();
}

}  // namespace bb
