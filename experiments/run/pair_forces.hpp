// Forces between bodies as a table: a row for every step and every two of them that touch.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/contact/contact_forces.hpp"
#include "core/model/scene/scene.hpp"
#include "experiments/run/body_pair.hpp"

namespace bb {

class Archive;

/// Sums over the rows of two bodies at the end of a step. An obstacle is a body; one may meet itself.
struct PairForce {
  int step = 0;
  double t_s = 0;
  BodyPair pair{0, 0};
  int contacts = 0;  // rows of contact, those that correct weights among them
  double
      normal_N = 0,
      friction_N =
          0;  // sums: of -kappa b' (below 0 where a row corrects weights) with restitution; of lengths of friction
  Vec3d contact = Vec3d::Zero(), friction = Vec3d::Zero();  // N, sums of vectors, on the first body
  double contact_work_J = 0, friction_work_J = 0;           // done on both
  std::optional<double> area_m2;                            // of weights by area
  void keep(Archive& archive);
};

/// Those of a run.
class PairForces {
 public:
  /// The scene must outlive it.
  explicit PairForces(const Scene& scene) : scene_(scene) {}
  /// The rows of the end of a step. Results do not depend on threads: they are summed in their order.
  void add(int step, double t_s, const std::vector<ContactForce>& rows);
  /// Rows ascend by step and by numbers of bodies; numbers have all their digits.
  std::string csv() const;
  void keep(Archive& archive);

 private:
  const Scene& scene_;
  std::vector<PairForce> rows_;
};

}  // namespace bb
