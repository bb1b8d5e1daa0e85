// How the forces of barriers answer to their stiffness: what the world puts on a contact stays when the barrier gets
// stiffer, what only the barrier's own stiffness makes, as between given bodies at a fixed distance, grows with it.
#pragma once

#include <utility>
#include <vector>

#include "core/contact/contact_table.hpp"
#include "core/energy/strain_limit_batch.hpp"
#include "core/newton/newton_system.hpp"

namespace bb {

/// d log f/d log s of every contact and limited element at one state, s a factor on the stiffness of contact and limit
/// together: 0 for a load, 1 for a force that is the stiffness times a fixed b'.
struct StiffnessAnswers {
  std::vector<std::pair<ContactKey, ContactKind>> row;  // ascending, mollified ones left out
  std::vector<double> contact;                          // [rows]
  std::vector<double> limit;    // [limited elements], of the singular value closer to its limit; 0 where it is slack
  bool known = true;            // false: no factor was found, and all are 0

  /// Of this contact; 0 for one that was not there.
  double of(const ContactKey& key, ContactKind kind) const;
  std::size_t bytes() const {
    return row.size() * sizeof(row[0]) + (contact.size() + limit.size()) * sizeof(double);
  }
};

/// Forces that answer by more than this are no loads: half way between one that stays and one that follows.
inline constexpr double largest_load_answer = 0.5;

/// The answers of the quasi-static state: H dx/ds = -(grad B + grad S) with the clamped H of elements, limit and
/// contacts, and f changes by 1 + b''/b' dd/ds. Inertia is left out but for 1e-6 of M/h^2, which holds bodies that
/// nothing else holds: within a step it resists every change, over the steps of a run it carries no load.
/// @param system assembled, with a fixed kappa and a barrier without potential
/// @param limit  the limited elements of the scene, or null; measured anew
/// @param dt     s
/// Cost: an assembly of clamped elements, a factorisation, a solve; none without an active barrier.
StiffnessAnswers answers_to_stiffness(NewtonSystem& system, StrainLimitBatch* limit,
                                      const BarrierFunction& limit_barrier, double dt);

}  // namespace bb
