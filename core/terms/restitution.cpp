// Restitution: every contact that a step begins with damps the speed at which its gap closes by load a, and that at which it opens
// by no more than the load (docs/theory/friction.md). Load, normal and weights are those of the start of the step, a is that of
// the speed at which the pair met.
#include <algorithm>

#include "core/base/archive/archive.hpp"
#include "core/exec/sums/executor_sum.hpp"
#include "core/terms/lagged_family_of.hpp"
#include "core/terms/registry.hpp"
#include "core/terms/restitution_rows.hpp"

namespace bb {
namespace {

/// The lesser restitution damps more.
class RestitutionFamily final : public LaggedFamilyOf<RestitutionRows> {
 public:
  RestitutionFamily(const FamilyPlace& place, const Scene& scene, const int* body)
      : LaggedFamilyOf(place, body, CombineRule::max, dampings(scene.bodies), dampings(scene.obstacles)),
        v0_(scene.v0),
        speed_(place.executor, "speeds of the step before"),
        known_pair_(place.executor, "pairs that met"),
        known_speed_(place.executor, "speeds of meeting"),
        met_(place.executor, "speeds of meeting of rows"),
        work_(place.executor) {
    upload(v0_);
  }

  void change_step(const FamilyStep& step) override { kind_.dt = step.dt; }
  void end_step(const double* x) override {
    place_.executor.each(speed_.size(), SpeedOfStep{x, x_n_, kind_.dt, speed_.data()});
    moved_ = true;
  }
  void keep(Archive& archive) override;

  void report_end(const double* x, StepNumbers& out) override {
    work_.clear();
    work_.add(size(), RestitutionWork{of_kind(), x});
    out.restitution_dissipation_J = work_.get().value();
  }

 private:
  /// In units of 1 over the speed at which a pair met.
  template <class Sides>
  static std::vector<double> dampings(const Sides& sides) {
    std::vector<double> out(sides.size());
    std::transform(sides.begin(), sides.end(), out.begin(),
                   [](const auto& side) { return restitution_damping(side.restitution.value_or(1)); });
    return out;
  }
  void strengthen() override {
    place_.executor.each(size(), DampByMeeting{met_.data(), rows_.strength.data()});
  }
  void rows_changed() override {
    met_.fit(size());
    place_.executor.each(size(),
                         RememberMeeting{view(),
                                         rows_.pair.data(),
                                         {known_pair_.data(), known_speed_.data(), known_pair_.size()},
                                         speed_.data(),
                                         met_.data()});
    known_pair_.fit(size()), known_speed_.fit(size());
    const auto n = static_cast<std::size_t>(size());
    place_.executor.copy(known_pair_.data(), rows_.pair.data(), n * sizeof(PairId));
    place_.executor.copy(known_speed_.data(), met_.data(), n * sizeof(double));
  }
  std::vector<double> kept() const override { return met_.download(); }
  void adopt_kept(const LaggedState& known) override {
    known_pair_.upload(known.pair);
    known_speed_.upload(known.kept);
  }

  void upload(const Positions& speed) {
    speed_.upload({speed.data(), static_cast<std::size_t>(speed.size())});
  }

  const Positions& v0_;         // m/s, of the scene
  exec::Buffer<double> speed_;  // [3 n_vertices] m/s, of the step before; at first that of the scene
  bool moved_ = false;          // a step was before
  exec::Buffer<PairId> known_pair_;
  exec::Buffer<double> known_speed_, met_;  // m/s
  exec::ExecutorSum work_;
};

// Before the first step there are no speeds to keep.
void RestitutionFamily::keep(Archive& archive) {
  Positions speed;
  if (moved_) {
    speed.resize(3, speed_.size() / 3);
    speed_.download({speed.data(), static_cast<std::size_t>(speed.size())});
  }
  std::vector<PairId> pairs = known_pair_.download();
  std::vector<double> speeds = known_speed_.download();
  archive(speed, pairs, speeds);
  if (!archive.reads()) return;
  moved_ = speed.cols() > 0;
  upload(moved_ ? speed : v0_);
  known_pair_.upload(pairs);
  known_speed_.upload(speeds);
}

}  // namespace

std::unique_ptr<LaggedFamily> restitution_family(const FamilyPlace& place, const Scene& scene,
                                                 const TermOptions&, const int* body) {
  return std::make_unique<RestitutionFamily>(place, scene, body);
}

PlanItem needs_restitution(const TermNeeds& needs) {
  const auto damps = [](const auto& one) { return one.restitution.value_or(1) < 1; };
  const auto& bodies = needs.scene.bodies;
  const auto& obstacles = needs.scene.obstacles;
  const bool some = std::any_of(bodies.begin(), bodies.end(), damps) ||
                    std::any_of(obstacles.begin(), obstacles.end(), damps);
  return plan_item(needs.contacts.any() && some, "speeds are kept in part",
                   needs.contacts.any() ? "no restitution is below 1" : "nothing can touch");
}

}  // namespace bb
