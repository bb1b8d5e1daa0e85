// The verb matrix: stored systems through every solver and estimator, as tables on stdout and JSON in a file.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/base/record/provenance.hpp"
#include "core/base/record/writer.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/matrix/replay_text.hpp"

namespace bb::cli {
namespace {

struct MatrixVerb {
  std::vector<std::string> files;  // NAME.mtx, with NAME.json beside it or without
  std::string json;                // file; empty: none
  double tol_rel = 1e-8;           // of iterative solvers
  int max_iterations = 10000;
  int dense_rows = 1500;  // up to which all eigenvalues are computed
};

/// Errors: ConfigError for an option outside its range.
ReplayOptions options_of(const MatrixVerb& verb) {
  if (!(verb.tol_rel > 0 && verb.tol_rel < 1))
    throw ConfigError("--tol", fmt::format("{}", verb.tol_rel), "above 0 and below 1");
  if (verb.max_iterations < 1)
    throw ConfigError("--max-iterations", fmt::format("{}", verb.max_iterations), "1 or more");
  if (verb.dense_rows < 0 || verb.dense_rows > 3000)
    throw ConfigError("--dense-rows", fmt::format("{}", verb.dense_rows), "0 to 3000");
  return {verb.tol_rel, verb.max_iterations, verb.dense_rows, 1};
}

/// Stored systems through every linear solver, preconditioner and condition estimator. What fails there is a
/// result. Errors: ConfigError as read_system.
int matrix(const MatrixVerb& verb, const CommonOptions& common) {
  const ReplayOptions options = options_of(verb);
  std::vector<StoredSystem> systems;  // all are read before the first is solved
  for (const std::string& file : verb.files) systems.push_back(read_system(file));
  nlohmann::ordered_json out = {{"schema", replay_schema},
                                {"tol_rel", options.tol_rel},
                                {"max_iterations", options.max_iterations},
                                {"seed", options.seed}};
  const Provenance provenance = collect_provenance(common.argv, 0);
  out["git_commit"] = provenance.git_commit;
  out["blas_kernel"] = provenance.blas.kernel;
  out["matrices"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < systems.size(); ++i) {
    const Replay result = replay(systems[i], options);
    show("{}{}", i > 0 ? "\n" : "", replay_table(verb.files[i], systems[i], result));
    out["matrices"].push_back(replay_json(verb.files[i], systems[i], result));
  }
  if (!verb.json.empty()) write_atomically(verb.json, out.dump(1) + "\n");
  return exit_ok;
}

}  // namespace

Action verb::matrix(CLI::App& app) {
  const auto verb = std::make_shared<MatrixVerb>();
  app.add_option("files", verb->files, "Matrix Market files, each with its side-car NAME.json or without")
      ->required();
  app.add_option("--json", verb->json, "file of everything that the tables show");
  app.add_option("--tol", verb->tol_rel, "|b - A x| <= tol |b| of iterative solvers (default 1e-8)")
      ->check(finite_number(0, 1, true));
  app.add_option("--max-iterations", verb->max_iterations, "their cap (default 10000)")
      ->check(CLI::Range(1, 1000000000));
  app.add_option("--dense-rows", verb->dense_rows,
                 "up to so many rows (default 1500, at most 3000) all eigenvalues are computed too")
      ->check(CLI::Range(0, 3000));
  return [verb](const CommonOptions& common) { return cli::matrix(*verb, common); };
}

}  // namespace bb::cli
