// Which run a record is of: schema, hashes of what made it, what it is called and what was requested.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/record/made_by.hpp"
#include "core/base/record/schema_version.hpp"

namespace bb {

inline constexpr const char* sha256_or_empty = "^([0-9a-f]{64})?$";

struct SchemaId {
  BB_RECORD(SchemaId, "what the file is");
  BB_FIELD(std::string, name, "always the same", "barrierbench.run") = run_schema_name;
  BB_FIELD(std::string, version, "model.revision.addition", "^3\\.[0-9]+\\.[0-9]+$") = run_schema_version;
  BB_RECORD_END;
};

struct Ids {
  BB_RECORD(Ids, "sha256 of what made the record");
  BB_FIELD(std::string, config_id,
           "of the canonical resolved config without threads; files by content and suffix", sha256_or_empty);
  BB_FIELD(std::string, run_id, "of all: config, executable, libraries, plugins, machine, threads",
           sha256_or_empty);
  BB_FIELD(std::string, build_id, "of the executable", sha256_or_empty);
  BB_FIELD(std::string, machine_id, "of processor model, core count, kernel of the system and card",
           sha256_or_empty);
  BB_FIELD(std::optional<std::string>, sweep_id, "of the sweep that the run is a case of");
  BB_FIELD(std::optional<std::string>, rerun_of, "run_id of the record that this run repeats",
           sha256_or_empty);
  BB_RECORD_END;
};

struct Labels {
  BB_RECORD(Labels, "what tables group by; derived from the config, never read back");
  BB_FIELD(std::string, scene, "name of the scene");
  BB_FIELD(
      std::string, method,
      "name of the published method; `NAME, changed` where the config overrides some of it; empty: none");
  BB_FIELD(std::string, formulation, "name of the preset, or the shape");
  BB_FIELD(std::string, shape, "b(d; d_hat)");
  BB_FIELD(std::string, argument, "what the shape is applied to");
  BB_FIELD(std::string, stiffness_policy, "how contacts get their kappa");
  BB_FIELD(std::string, integrator, "time integrator");
  BB_FIELD(std::string, step_solver, "order of events in a step");
  BB_FIELD(std::string, linear_solver, "of the Newton step");
  BB_FIELD(std::string, preconditioner,
           "of a solver by conjugate gradients; none for others, and of pcg_resident before 3.8.0");
  BB_FIELD(std::string, precision, "of the solver");
  BB_FIELD(double, d_hat_m, "width of the contact barrier") = 0;
  BB_FIELD(double, dt_s, "time step") = 0;
  BB_FIELD(std::string, note,
           "what tables call the run: SWEEP: CASE, or NAME: FORMULATION of a run of no sweep (/name of its "
           "config, or the scene), which had none before 3.9.0");
  BB_FIELD(TextMap, swept, "of a case of a sweep: pointer -> value as JSON text, of its axes");
  BB_RECORD_END;
};

struct MethodRecord {
  BB_RECORD(MethodRecord, "the published method that was requested (configs/methods)");
  BB_FIELD(std::string, name, "empty: none was requested");
  BB_FIELD(std::string, source, "its publication");
  BB_FIELD(std::vector<std::string>, overridden,
           "pointers that the config sets otherwise than the method; with any of them the run is of no "
           "published method");
  BB_FIELD(TextMap, differs, "subject -> what of the publication this program does otherwise");
  BB_RECORD_END;
};

struct Passes {
  BB_RECORD(Passes, "what was requested");
  BB_FIELD(bool, time, "a run of its own, timed") = false;
  BB_FIELD(bool, diagnose, "condition estimates and trace") = false;
  BB_FIELD(bool, audit, "exact checks of every state and motion") = false;
  BB_RECORD_END;
};

}  // namespace bb
