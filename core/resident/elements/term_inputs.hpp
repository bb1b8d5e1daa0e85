// What terms are made from on an executor, and the list that they are added to.
#pragma once

#include <memory>
#include <vector>

#include "core/resident/elements/element_matrix.hpp"
#include "core/resident/elements/resident_term.hpp"
#include "core/resident/sums/vectors.hpp"
#include "core/scene/contact_plan.hpp"
#include "core/scene/scene.hpp"
#include "core/terms/term_options.hpp"

namespace bb::resident {

/// All of it outlives the term.
struct ResidentInputs {
  exec::Executor& executor;
  const Scene& scene;
  const TermOptions& options;
  const ContactPlan& contacts;
  VectorTools& vectors;
  const Buffer<double>& mass;  // [n_vertices] kg, 0 for prescribed vertices
  ElementMatrix& matrix;       // of all terms with stencils that stay
};

/// The terms of a run in the order of core/terms/registry.inc, which is that of the sums.
class ResidentTermList {
 public:
  void add(std::unique_ptr<ResidentTerm> term) { terms_.push_back(std::move(term)); }
  auto begin() const { return terms_.begin(); }
  auto end() const { return terms_.end(); }
  std::size_t size() const { return terms_.size(); }
  ResidentTerm& operator[](std::size_t i) const { return *terms_[i]; }
  /// The first term of that class, or null.
  template <class T>
  T* find() const {
    for (const auto& term : terms_) {
      if (T* found = dynamic_cast<T*>(term.get())) return found;
    }
    return nullptr;
  }

 private:
  std::vector<std::unique_ptr<ResidentTerm>> terms_;
};

/// Makes the terms of one line of registry.inc. Errors: ConfigError for what has no device form; OutOfMemory.
using MakeResident = void(const ResidentInputs&, ResidentTermList&);

}  // namespace bb::resident
