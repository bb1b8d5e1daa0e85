// The words of the enumerations that a config names.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/base/parameters/parameter.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

template <class E>
using EnumWords = std::vector<std::pair<E, std::string>>;

inline EnumWords<Argument> words_of(Argument) {
  return {{Argument::gap, "gap"}, {Argument::squared_gap, "squared_gap"}};
}
inline EnumWords<SaddleRule> words_of(SaddleRule) {
  return {{SaddleRule::escape, "escape"}, {SaddleRule::report, "report"}, {SaddleRule::ignore, "ignore"}};
}
inline EnumWords<MatchingRule> words_of(MatchingRule) {
  return {{MatchingRule::as_given, "as_given"},
          {MatchingRule::equal_force, "equal_force"},
          {MatchingRule::equal_curvature, "equal_curvature"}};
}
inline EnumWords<Mollifier> words_of(Mollifier) {
  return {{Mollifier::ipc, "ipc"}, {Mollifier::none, "none"}};
}
inline EnumWords<StepBoundRule> words_of(StepBoundRule) {
  return {{StepBoundRule::accd, "accd"},
          {StepBoundRule::planar_truncation, "planar_truncation"},
          {StepBoundRule::planar_balanced, "planar_balanced"},
          {StepBoundRule::per_vertex, "per_vertex"}};
}
inline EnumWords<ContactWeighting> words_of(ContactWeighting) {
  return {{ContactWeighting::none, "none"},
          {ContactWeighting::area, "area"},
          {ContactWeighting::area_corrected, "area_corrected"}};
}
inline EnumWords<ContactModel> words_of(ContactModel) {
  return {{ContactModel::all_pairs, "all_pairs"},
          {ContactModel::offset_geometric, "offset_geometric"},
          {ContactModel::points, "points"}};
}
inline EnumWords<StepSizeRule> words_of(StepSizeRule) {
  return {{StepSizeRule::fixed, "fixed"}, {StepSizeRule::adaptive, "adaptive"}};
}
inline EnumWords<RestRule> words_of(RestRule) { return {{RestRule::on, "on"}, {RestRule::off, "off"}}; }
inline EnumWords<FrictionHessian> words_of(FrictionHessian) {
  return {{FrictionHessian::exact, "exact"},
          {FrictionHessian::adaptive, "adaptive"},
          {FrictionHessian::secant, "secant"}};
}
inline EnumWords<FrictionRefresh> words_of(FrictionRefresh) {
  return {{FrictionRefresh::per_step, "per_step"}, {FrictionRefresh::per_iteration, "per_iteration"}};
}
inline EnumWords<CombineRule> words_of(CombineRule) {
  return {{CombineRule::min, "min"}, {CombineRule::max, "max"}, {CombineRule::mean, "mean"}};
}
inline EnumWords<HessianMode> words_of(HessianMode) {
  return {{HessianMode::gauss_newton, "gauss_newton"},
          {HessianMode::projected_full, "projected_full"},
          {HessianMode::projected_numeric, "projected_numeric"},
          {HessianMode::projected_lapack, "projected_lapack"},
          {HessianMode::projected_low_rank, "projected_low_rank"}};
}
inline EnumWords<Scaling> words_of(Scaling) {
  return {{Scaling::none, "none"}, {Scaling::jacobi, "jacobi"}, {Scaling::block_jacobi, "block_jacobi"}};
}
inline EnumWords<Estimator> words_of(Estimator) {
  return {{Estimator::ritz, "ritz"},
          {Estimator::inverse_power, "inverse_power"},
          {Estimator::spectra, "spectra"},
          {Estimator::dense, "dense"},
          {Estimator::lanczos, "lanczos"}};
}
inline EnumWords<Device> words_of(Device) {
  return {{Device::cpu, "cpu"}, {Device::host, "host"}, {Device::cuda, "cuda"}};
}
inline EnumWords<Precision> words_of(Precision) {
  return {{Precision::full, "double"}, {Precision::mixed, "mixed"}, {Precision::single, "float"}};
}
inline EnumWords<BodyKind> words_of(BodyKind) {
  return {{BodyKind::deformable, "deformable"}, {BodyKind::rigid, "rigid"}};
}
inline EnumWords<StiffnessKind> words_of(StiffnessKind) {
  return {{StiffnessKind::membrane, "membrane"},
          {StiffnessKind::hinges, "hinges"},
          {StiffnessKind::springs, "springs"}};
}
inline EnumWords<CollisionKind> words_of(CollisionKind) {
  return {{CollisionKind::ccd, "ccd"},
          {CollisionKind::audited, "audited"},
          {CollisionKind::static_test, "static"},
          {CollisionKind::proximity, "proximity"},
          {CollisionKind::off, "off"}};
}
inline EnumWords<CollisionChoice> words_of(CollisionChoice) {
  return {{CollisionChoice::automatic, "auto"},      {CollisionChoice::ccd, "ccd"},
          {CollisionChoice::audited, "audited"},     {CollisionChoice::static_test, "static"},
          {CollisionChoice::proximity, "proximity"}, {CollisionChoice::off, "off"}};
}
inline EnumWords<PlanarPairs> words_of(PlanarPairs) {
  return {{PlanarPairs::point_edge, "point_edge"}, {PlanarPairs::vertex_vertex, "vertex_vertex"}};
}
inline EnumWords<ObstacleKind> words_of(ObstacleKind) {
  return {
      {ObstacleKind::plane, "plane"}, {ObstacleKind::sphere, "sphere"}, {ObstacleKind::cylinder, "cylinder"}};
}

template <class E>
std::string word_of(E value) {
  for (const auto& [each, text] : words_of(value)) {
    if (each == value) return text;
  }
  return "";
}

template <class E>
Rule one_of() {
  std::vector<std::string> out;
  for (const auto& [each, text] : words_of(E())) out.push_back(text);
  return word(std::move(out));
}
template <class E>
Rule some_of() {
  return words(one_of<E>().words());
}

}  // namespace bb
