// How the forces of barriers answer to their stiffness: what the world puts on a contact stays when the barrier gets
// stiffer, what only the barrier's own stiffness makes, as between prescribed bodies at a fixed distance, grows with it.
#pragma once

#include <utility>
#include <vector>

#include "core/contact/contact_table.hpp"
#include "core/energy/families/limit_family.hpp"
#include "core/newton/newton_system.hpp"

namespace bb {

/// d log f/d log s of every contact and limited element at one state, s a factor on the stiffness of contact and limit
/// together: 0 for a load, 1 for a force that is the stiffness times a fixed b'.
struct StiffnessAnswers {
  std::vector<double> contact;  // [rows], mollified ones left out
  std::vector<double>
      limit;          // [limited elements], of the singular value closer to its limit; 0 where it is slack
  bool known = true;  // false: no factor was found, and all are 0
};

/// Forces that answer by more than this are no loads: half way between one that stays and one that follows.
inline constexpr double largest_load_answer = 0.5;

/// The answers of many states together: sum of f d log f/d log s over sum of f, that is d log(sum of f)/d log s, of the
/// forces of each vertex and each limited element. In one state contacts side by side pass forces on to each other, and
/// a squeezed body that swings looks as if its momentum pressed it; over a run that cancels.
class AnswerSums {
 public:
  AnswerSums() = default;
  AnswerSums(int n_vertices, std::size_t n_elements)
      : contact_(static_cast<std::size_t>(n_vertices)), limit_(n_elements) {}
  /// A force f > 0 (N) on the free vertices of a row, with this answer.
  void add_contact(const ContactTable& rows, std::size_t row, double force, double answer);
  void add_limit(std::size_t element, double force, double answer) { limit_[element].add(force, answer); }
  /// Of the forces of a row's free vertices, by their weights; 0 where none was added.
  double of_contact(const ContactTable& rows, std::size_t row) const;
  double of_limit(std::size_t element) const { return limit_[element].mean(); }
  std::size_t bytes() const { return (contact_.size() + limit_.size()) * sizeof(Sum); }

 private:
  struct Sum {
    double force = 0, change = 0;
    void add(double f, double answer) { force += f, change += f * answer; }
    double mean() const { return force > 0 ? change / force : 0; }
  };
  std::vector<Sum> contact_, limit_;  // [vertices], [elements]
};

/// The answers of the quasi-static state: H dx/ds = -(grad B + grad S) with the clamped H of elements, limit and
/// contacts, and f changes by 1 + b''/b' dd/ds. Inertia is left out but for 1e-6 of M/h^2, which holds bodies that
/// nothing else holds: within a step it resists every change, over the steps of a run it carries no load.
/// @param system assembled, with a fixed kappa and a barrier without potential
/// @param limit  the limited triangles of the scene in the host's memory, or null; measured anew
/// @param dt     s
/// Cost: an assembly of clamped elements, a factorisation, a solve; none without an active barrier.
StiffnessAnswers answers_to_stiffness(Diagnosis& system, LimitFamily* limit,
                                      const BarrierFunction& limit_barrier, double dt);

}  // namespace bb
