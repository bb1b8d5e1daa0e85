// What terms are made from on an executor, and the list that they are added to.
#pragma once

#include "core/exec/sums/vectors.hpp"
#include "core/model/scene/contact_plan.hpp"
#include "core/model/scene/scene.hpp"
#include "core/terms/executor/element_matrix.hpp"
#include "core/terms/executor/executor_term.hpp"
#include "core/terms/list_of_terms.hpp"
#include "core/terms/term_options.hpp"

namespace bb::exec {

/// All of it outlives the term.
struct ExecutorInputs {
  Executor& executor;
  const Scene& scene;
  const TermOptions& options;
  const ContactPlan& contacts;
  VectorTools& vectors;
  const Buffer<double>& mass;  // [n_vertices] kg, 0 for prescribed vertices
  ElementMatrix& matrix;       // of all terms with stencils that stay
};

using ExecutorTerms = ListOfTerms<ExecutorTerm>;

/// Makes the terms of one line of registry.inc. Errors: ConfigError for what has no device form; OutOfMemory.
using MakeOnExecutor = void(const ExecutorInputs&, ExecutorTerms&);

}  // namespace bb::exec
