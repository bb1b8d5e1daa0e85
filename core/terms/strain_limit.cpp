#include "core/terms/strain_limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/math/parallel.hpp"
#include "core/terms/barrier_load.hpp"
#include "core/terms/registry.hpp"

namespace bb {

StrainLimitTerm::StrainLimitTerm(exec::Executor& executor, const Scene& scene, const TermOptions& options,
                                 const std::vector<std::uint8_t>& fixed, bool of_solids)
    : LimitSteps(std::make_unique<StrainLimitState>(executor, scene, options, of_solids, scene.mass.data())),
      scene_(scene),
      options_(options),
      fixed_(fixed) {
  const auto n = static_cast<std::size_t>(state_->family().size());
  TermFamily& family = families_.emplace_back();
  family.stencils = {state_->family().width(), state_->family().vertices()};
  family.local.resize(n, state_->family().width());
  family.trial_energy.resize(n);
}

void StrainLimitTerm::linearise(const PositionsView& x, const TermContext& context) {
  ElasticMatrix elastic;
  if (state_->asks_for_elastic()) {
    elastic = gather_elastic(state_->family(), pattern(), elastic_values(), hess_);
  }
  state_->refresh(x.data(), elastic, energies());
  state_->family().derivatives(x.data(), context.projection, families_[0].local);
}

void StrainLimitTerm::clamp(const PositionsView& x) {
  state_->measure_iterate(x.data(), energies());
  state_->family().derivatives(x.data(), Projection::psd, families_[0].clamped);
}

ElasticMatrix gather_elastic(const LimitFamily& family, const BlockSystem& blocks,
                             const BlockSystem::Values& elastic, std::vector<double>& out) {
  const std::span<const int> vertices = family.vertices();
  const int width = family.width(), size = 3 * width;
  const auto n = static_cast<std::size_t>(family.size()),
             numbers = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  out.resize(numbers * n);
  parallel_items(n, 64, [&](std::size_t e) {
    Mat<double, 12, 12> block;
    blocks.submatrix(elastic, &vertices[static_cast<std::size_t>(width) * e], width, block.data());
    Eigen::Map<Eigen::MatrixXd>(&out[numbers * e], size, size) = block.topLeftCorner(size, size);
  });
  return {{}, out.data()};
}

// Of element e on its own: how many times larger its force would have to be to balance the rest along itself.
double StrainLimitTerm::times_larger(std::size_t e, const PositionsView& others) const {
  const std::vector<double>& gradient = families_[0].local.grad;
  const auto width = static_cast<std::size_t>(state_->family().width());
  double needed = 0, own = 0;
  for (std::size_t k = 0; k < width; ++k) {
    const auto v = static_cast<std::size_t>(state_->family().vertices()[width * e + k]);
    for (std::size_t c = 0; c < 3; ++c) {
      if (fixed_[3 * v + c]) continue;  // carried by the pin
      const double g = gradient[3 * (width * e + k) + c];
      needed -= g * others.data()[3 * v + c];
      own += g * g;
    }
  }
  return own > std::numeric_limits<double>::min() ? needed / own : 0;
}

std::string StrainLimitTerm::element_name(std::size_t e) const {
  const auto width = static_cast<std::size_t>(state_->family().width());
  const std::span<const int> vertices = state_->family().vertices().subspan(width * e, width);
  const Body& body =
      scene_.bodies[static_cast<std::size_t>(scene_.body[static_cast<std::size_t>(vertices[0])])];
  std::string numbers;
  for (const int v : vertices)
    numbers += fmt::format("{}{}", numbers.empty() ? "" : " ", v - body.first_vertex);
  return fmt::format("{} {}[{}]", state_->of_solids() ? "tetrahedron" : "triangle", body.name, numbers);
}

// The larger of two estimates: what everything but the limit puts on an element on its own, and the force at
// which the Newton model would come to rest.
void StrainLimitTerm::report_overload(const PositionsView& x, const PositionsView& others,
                                      const PositionsView& dx, StepNumbers& out) {
  if (!state_->adds()) out.limit_overload = 0;
  if (options_.limit.shape.infinite_at_zero || state_->policy().has_potential()) return;
  const Positions moved = x + dx;
  const std::vector<double> gaps = state_->family().smallest_gaps(x.data()),
                            next = state_->family().smallest_gaps(moved.data());
  state_->forget();
  const StrainBands& bands =
      state_->of_solids() ? static_cast<const StrainBands&>(scene_.solid_limit) : scene_.limit;
  LargestSlope slope(options_.limit);
  double largest = state_->adds() ? out.limit_overload.value : 0;
  for (std::size_t e = 0; e < gaps.size(); ++e) {
    const double width = bands.width[e];
    if (!(gaps[e] < width)) continue;
    const double capacity = slope(width);
    const double share = -options_.limit.eval(gaps[e], width).db / capacity;
    const double times = std::max(share * times_larger(e, others),
                                  newton_force(options_.limit, gaps[e], next[e], width) / capacity);
    if (!(times > largest)) continue;
    largest = times;
    out.limit_overload_at = element_name(e);
  }
  out.limit_overload = largest;
}

PlanItem needs_strain_limit(const TermNeeds& needs) {
  const std::size_t n = needs.scene.limit.triangles.size(), m = needs.scene.solid_limit.tetrahedra.size();
  std::string found = fmt::format("{} limited triangles", n);
  if (m > 0) found = (n > 0 ? found + ", " : "") + fmt::format("{} limited tetrahedra", m);
  return plan_item(needs.options.strain_limit && n + m > 0, found,
                   needs.options.strain_limit ? "no limited triangle" : "strain_limit is not enabled");
}

void make_strain_limit(const TermInputs& inputs, TermList& terms) {
  const auto add = [&](bool of_solids) {
    terms.add(std::make_unique<StrainLimitTerm>(inputs.executor, inputs.scene, inputs.options, inputs.fixed,
                                                of_solids));
  };
  if (!inputs.scene.limit.triangles.empty()) add(false);
  if (!inputs.scene.solid_limit.tetrahedra.empty()) add(true);
}

}  // namespace bb
