// Restitution on an executor. The speeds at which pairs met stay there from step to step.
#include "core/archive/archive.hpp"
#include "core/resident/system/lagged_term.hpp"
#include "core/terms/contact_damping.hpp"

namespace bb::resident {
namespace {

class RestitutionTerm final : public LaggedTerm<DampingRows> {
 public:
  RestitutionTerm(const ResidentInputs& inputs, ResidentContact& contact, std::span<const double> of_body,
                  std::span<const double> of_obstacle)
      : LaggedTerm(inputs, contact, CombineRule::max, of_body, of_obstacle),
        speed_(executor_, "speeds of the step before"),
        known_pair_(executor_, "pairs that met"),
        known_speed_(executor_, "speeds of meeting"),
        met_(executor_, "speeds of meeting of rows"),
        work_(executor_) {
    const Positions& v0 = inputs.scene.v0;
    speed_.upload({v0.data(), static_cast<std::size_t>(v0.size())});
  }
  std::string_view name() const override { return "restitution"; }

  void begin_step(const ResidentFrame& frame) override {
    LaggedTerm::begin_step(frame);
    remember();
  }
  void change_frame(const ResidentFrame& frame) override { rows_.dt = frame.dt; }
  void end_step(const Column& x, PhaseClock&) override {
    executor_.each(x.size(), SpeedOfStep{x.data(), rows_.x_n, rows_.dt, speed_.data()});
    moved_ = true;
  }
  void keep(Archive& archive) override;

  void report_end(const Column& x, StepNumbers& out) override {
    if (!lag_.known()) return;
    work_.clear();
    work_.add(size(), DampingOfRows{rows(), x.data()});
    out.restitution_dissipation_J = work_.get().value();
  }

 private:
  void strengthen() override {
    executor_.each(size(), DampByMeeting{met_.data(), least_meeting_speed, lag_.strength()});
  }
  void remember() {
    met_.fit(size());
    executor_.each(size(), RememberMeeting{rows(),
                                           lag_.pairs(),
                                           {known_pair_.data(), known_speed_.data(), known_pair_.size()},
                                           speed_.data(),
                                           met_.data()});
    known_pair_.fit(size()), known_speed_.fit(size());
    const auto n = static_cast<std::size_t>(size());
    executor_.copy(known_pair_.data(), lag_.pairs(), n * sizeof(Key));
    executor_.copy(known_speed_.data(), met_.data(), n * sizeof(double));
  }

  Column speed_;        // m/s, of the step before; at first that of the scene
  bool moved_ = false;  // a step was before
  Buffer<Key> known_pair_;
  Buffer<double> known_speed_, met_;  // m/s
  ResidentSum work_;
};

// As the host's term, which keeps no speeds before its first step.
void RestitutionTerm::keep(Archive& archive) {
  ResidentTerm::keep(archive);
  Positions speed;
  if (moved_) {
    speed.resize(3, speed_.size() / 3);
    speed_.download({speed.data(), static_cast<std::size_t>(speed.size())});
  }
  std::vector<Key> pairs = known_pair_.download();
  std::vector<double> speeds = known_speed_.download();
  archive(speed, pairs, speeds);
  if (!archive.reads()) return;
  moved_ = speed.cols() > 0;
  if (moved_) speed_.upload({speed.data(), static_cast<std::size_t>(speed.size())});
  known_pair_.upload(pairs);
  known_speed_.upload(speeds);
}

template <class Sides>
std::vector<double> dampings_of(const Sides& sides) {
  std::vector<double> out;
  for (const auto& side : sides) out.push_back(damping_of(side));
  return out;
}

}  // namespace

void make_resident_restitution(const ResidentInputs& inputs, ResidentTermList& terms) {
  terms.add(std::make_unique<RestitutionTerm>(inputs, contact_of(terms), dampings_of(inputs.scene.bodies),
                                              dampings_of(inputs.scene.obstacles)));
}

}  // namespace bb::resident
