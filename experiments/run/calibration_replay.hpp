// The states of a calibration run once more, in a system that is never stepped: rows, elastic matrix and Hessians at the ends of
// its steps.
#pragma once

#include <memory>

#include "core/barrier/stiffness_policy.hpp"
#include "core/model/scene/held_scene.hpp"
#include "core/newton/newton_system.hpp"
#include "core/terms/contact.hpp"
#include "experiments/run/calibration_run.hpp"

namespace bb {

class CalibrationReplay {
 public:
  /// Both must outlive it.
  CalibrationReplay(const CalibrationRun& calibration_run, const Scene& scene)
      : calibration_run_(calibration_run),
        method_(make_method(calibration_run.config, calibration_run.stiffness)),
        scene_(scene),
        held_(scene, calibration_run.config.time.dt / 2),
        system_(std::make_unique<NewtonSystem>(held_.now(), method_)) {}

  /// The rows of the end of this step.
  void find_rows(int step) { begin(end(step), step); }
  /// The same, with the H that a policy of this refresh reads while the step's end is reached. Cost: an assembly.
  void find_rows(int step, Refresh refresh);
  /// All terms at the end of this step. Cost: an assembly.
  Diagnosis& assembled(int step);

  const Positions& start(int step) const { return calibration_run_.x[static_cast<std::size_t>(step)]; }
  const Positions& end(int step) const { return calibration_run_.x[static_cast<std::size_t>(step) + 1]; }
  double c(int step) const { return calibration_run_.c[static_cast<std::size_t>(step)]; }
  const ContactTable& rows() const { return contact_state(diagnosis().terms()).rows; }
  /// Requires rows.
  ContactTerm& contact() const { return *diagnosis().terms().find<ContactTerm>(); }
  /// H of the last find_rows with a refresh, and the system whose pattern it has.
  const BlockSystem::Values& elastic() const { return elastic_; }
  const BlockSystem& blocks() const { return diagnosis().blocks(); }

 private:
  void begin(const Positions& x, int step);
  void hold_pins(int step);
  Diagnosis& diagnosis() const { return system_->diagnosis(); }

  const CalibrationRun& calibration_run_;
  Method method_;
  const Scene& scene_;
  HeldScene held_;  // of it, with the pins of the step
  std::unique_ptr<NewtonSystem> system_;
  Prediction prediction_;
  BlockSystem::Values elastic_;
};

}  // namespace bb
