#include "core/linear/executor/executor_preconditioner.hpp"

#include "core/linear/executor/block_jacobi.hpp"
#include "core/linear/executor/multilevel_schwarz.hpp"

namespace bb::exec {

std::vector<Parameter> preconditioner_parameters() {
  return {{"resident_preconditioner",
           word({"block_jacobi", "multilevel_schwarz"}, {{"schwarz", "multilevel_schwarz"}}), "block_jacobi",
           "the 3 x 3 blocks of the diagonal, or clusters of vertices on several levels"},
          {"resident_cluster_vertices", count(1, MultilevelSchwarz::most_cluster_vertices), 8,
           "vertices of a cluster of multilevel_schwarz, and clusters of one on the level above"}};
}

std::unique_ptr<ExecutorPreconditioner> make_preconditioner(Executor& executor,
                                                            const ParameterMap& parameters) {
  if (text(parameters, "resident_preconditioner") == "multilevel_schwarz" && !executor.counts_only()) {
    return std::make_unique<MultilevelSchwarz>(executor, integer(parameters, "resident_cluster_vertices"));
  }
  return std::make_unique<BlockJacobi>(executor);
}

}  // namespace bb::exec
