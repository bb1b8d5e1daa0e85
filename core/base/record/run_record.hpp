// What one run leaves behind, as plain values: run.json is exactly this struct (writer.hpp), the trace beside
// it holds one TraceRow a Newton iteration.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/record/judged_record.hpp"
#include "core/base/record/made_by.hpp"
#include "core/base/record/matching_record.hpp"
#include "core/base/record/outcome.hpp"
#include "core/base/record/run_identity.hpp"
#include "core/base/record/step_record.hpp"
#include "core/base/record/summary_record.hpp"

namespace bb {

using SampleMap = std::map<std::string, std::vector<double>>;

/// A JSON object kept as its text.
struct JsonText {
  std::string text = "{}";
};

struct Status {
  BB_RECORD(Status, "how the run ended");
  BB_FIELD(
      Outcome, outcome,
      "of several that hold, the first in the order of this list; where time or memory ended a run, that") =
      Outcome::ok;
  BB_FIELD(std::string, detail,
           "one sentence; empty when ok, but for what a step solver or a contact model leaves open");
  BB_FIELD(bool, valid, "every check of `validity` passed") = false;
  BB_FIELD(Number, resumed_from_step, "first step after the checkpoint that the run went on from",
           "whole") = Number::missing("whole");
  BB_FIELD(std::string, started_utc, "ISO 8601");
  BB_FIELD(std::string, ended_utc, "ISO 8601");
  BB_RECORD_END;
};

/// Elements of every part, part by part.
struct PartSizes {
  BB_RECORD_LIST(PartSizes, "elements of the scene");
#define PART(name, term, convex, where, field, ...) BB_FIELD(std::size_t, field, __VA_ARGS__) = 0;
#include "core/model/scene/parts/registry.inc"
#undef PART
};

struct SceneSize : PartSizes {
  BB_RECORD(SceneSize, "sizes of the scene that was built");
  BB_FIELD(std::size_t, vertices, "given and free") = 0;
  BB_FIELD(std::size_t, free_dofs, "degrees of freedom of vertices that are not prescribed") = 0;
  BB_FIELDS_OF(PartSizes)
  BB_FIELD(std::size_t, obstacles, "analytic surfaces") = 0;
  BB_FIELD(double, extent_m, "largest side of the start box") = 0;
  BB_FIELD(TextMap, mesh_sha256, "mesh file, relative to the folder of this record -> sha256");
  BB_RECORD_END;
};

struct PlanLine {
  BB_RECORD(PlanLine, "what the scene needs, and what is neither allocated nor run");
  BB_FIELD(std::string, item, "a part of the program");
  BB_FIELD(bool, active, "whether it runs") = false;
  BB_FIELD(std::string, reason, "why, or why not");
  BB_RECORD_END;
};

struct Skipped {
  BB_RECORD(Skipped, "a measure that the record lacks");
  BB_FIELD(std::string, metric, "time, cond, audit, trace");
  BB_FIELD(std::string, reason, "why", "not_requested build_not_valid");
  BB_RECORD_END;
};

struct Artifact {
  BB_RECORD(Artifact, "a file of the run beside run.json");
  BB_FIELD(std::string, path, "relative to the folder of this record");
  BB_FIELD(std::string, kind, "what it is", "frame frame_scene matrix matrix_side_car pair_forces trace");
  BB_FIELD(std::string, media_type, "of its format");
  BB_FIELD(std::string, sha256, "of its bytes", sha256_or_empty);
  BB_FIELD(std::uint64_t, bytes, "its size") = 0;
  BB_RECORD_END;
};

struct RunRecord {
  BB_RECORD(RunRecord, "run.json of one run; the version is that of the trace beside it too");
  BB_FIELD(SchemaId, schema, "what the file is");
  BB_FIELD(Ids, ids, "what made it, as hashes");
  BB_FIELD(Status, status, "how it ended");
  BB_FIELD(Labels, labels, "what tables group by");
  BB_FIELD(MethodRecord, method, "the published method that was requested");
  BB_FIELD(Passes, passes, "what was requested");
  BB_FIELD(JsonText, config,
           "resolved, every default filled in, mesh files relative to the folder of this record: `bench run "
           "run.json` repeats the run");
  BB_FIELD(SceneSize, scene, "sizes");
  BB_FIELD(Provenance, provenance, "the program");
  BB_FIELD(Machine, machine, "where it ran");
  BB_FIELD(std::vector<PlanLine>, plan, "what ran and what did not");
  BB_FIELD(std::vector<Skipped>, skipped, "what the record lacks");
  BB_FIELD(MatchingRecord, matching, "how stiffness was chosen");
  BB_FIELD(Summary, summary, "the run in numbers");
  BB_FIELD(std::vector<StepRecord>, steps, "one by one");
  BB_FIELD(SampleMap, samples, "raw repetitions, name with its unit -> values");
  BB_FIELD(AuditRecord, audit, "what was judged");
  BB_FIELD(Validity, validity, "whether the run counts");
  BB_FIELD(Comparability, comparability, "whether it may be compared");
  BB_FIELD(std::vector<Artifact>, artifacts, "files beside it");
  BB_RECORD_END;
};

}  // namespace bb
