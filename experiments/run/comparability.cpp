#include "experiments/run/comparability.hpp"

#include <fmt/format.h>

#include <vector>

#include "core/math/error.hpp"
#include "core/record/folder_lock.hpp"
#include "core/record/writer.hpp"

namespace bb {
namespace {

bool in_contact(const ComparedRun& run) { return run.gap_rel.finite(); }

void append(std::string& list, const std::string& name) { list += (list.empty() ? "" : ", ") + name; }

ComparedRun without_record(const std::filesystem::path& folder) {
  ComparedRun out;
  out.folder = folder.filename().string();
  out.gap_rel = Number::missing("no_reference");
  return out;
}

std::string fault_of(const ComparedRun& run) {
  if (run.run_id.empty()) return "it left no record";
  return "outcome " + run.outcome + (run.failed.empty() ? "" : ", failed checks: " + run.failed);
}

std::string reason_of(const Comparability& c) {
  return fmt::format("smallest gap {:.3g} d_hat, {:.3g} times that of the reference: {}within a factor {:g}",
                     c.gap_rel.value, c.ratio.value, c.verdict == "comparable" ? "" : "not ", c.max_ratio);
}

/// Nothing where no record of this very version can be read: what is written again would lose what this
/// program does not know.
std::optional<RunRecord> read_member(const std::filesystem::path& folder) {
  try {
    auto record = read_run(folder / "run.json");
    if (record && record->schema.version == run_schema_version) return record;
  } catch (const ConfigError&) {
  }
  return {};
}

}  // namespace

ComparedRun compared_run(const RunRecord& record, const std::filesystem::path& folder) {
  ComparedRun out;
  out.folder = folder.filename().string();
  out.run_id = record.ids.run_id;
  out.outcome = std::string(to_string(record.status.outcome));
  out.shape = record.labels.shape;
  out.argument = record.labels.argument;
  out.matching_rule = record.matching.rule;
  out.valid = record.validity.valid;
  for (const Check& check : record.validity.checks) {
    if (!check.pass) append(out.failed, check.name);
  }
  out.gap_rel = record.summary.gap_min_rel.min;
  if (!out.gap_rel.finite()) out.gap_rel = Number::missing("no_contacts");
  return out;
}

Comparability judge_comparability(const ComparedRun& run, const std::optional<ComparedRun>& reference) {
  Comparability out;
  out.gap_rel = run.gap_rel;
  out.reference_gap_rel = out.ratio = Number::missing("no_reference");
  if (reference) {
    out.reference_run = reference->folder;
    out.reference_run_id = reference->run_id;
    out.reference_gap_rel = reference->gap_rel;
  }
  const bool usable = reference && reference->valid && in_contact(*reference);
  if (usable && in_contact(run)) out.ratio = run.gap_rel.value / reference->gap_rel.value;
  if (!run.valid) {
    out.verdict = "not_valid";
    out.reason = "the run is not valid: " + fault_of(run);
  } else if (!reference) {
    out.verdict = "no_reference";
    out.reason = "no valid run of a finished sweep to compare with";
  } else if (!usable) {
    out.verdict = "no_reference";
    out.reason = reference->valid ? "the reference has no contact at the end of a converged step"
                                  : "the reference is not valid: " + fault_of(*reference);
  } else if (!in_contact(run)) {
    out.verdict = "not_comparable";
    out.reason = "no contact at the end of a converged step, where the reference has some";
  } else {
    const double ratio = out.ratio.value;
    out.verdict = ratio >= 1 / out.max_ratio && ratio <= out.max_ratio ? "comparable" : "not_comparable";
    out.reason = run.folder == reference->folder ? "the reference itself" : reason_of(out);
  }
  return out;
}

std::optional<std::size_t> default_reference(std::span<const SweepMember> members,
                                             std::span<const std::optional<ComparedRun>> runs,
                                             std::size_t index) {
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (members[i].group != members[index].group) continue;
    if (!runs[i] || !runs[i]->valid || !in_contact(*runs[i])) continue;
    const bool log = runs[i]->shape == "log" && runs[i]->argument == "gap";
    if (log && runs[index] && runs[i]->matching_rule == runs[index]->matching_rule) return i;
    if (!first) first = i;
  }
  return first;
}

void write_comparability(std::span<const SweepMember> members) {
  std::vector<std::optional<RunRecord>> records;
  std::vector<std::optional<ComparedRun>> runs;
  for (const SweepMember& member : members) {
    records.push_back(member.ran ? read_member(member.folder) : std::nullopt);
    runs.push_back(std::nullopt);
    if (records.back()) runs.back() = compared_run(*records.back(), member.folder);
  }
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (!runs[i]) continue;
    const auto chosen = members[i].reference ? members[i].reference : default_reference(members, runs, i);
    std::optional<ComparedRun> reference;
    if (chosen) reference = runs[*chosen] ? runs[*chosen] : without_record(members[*chosen].folder);
    RunRecord judged = *records[i];
    judged.comparability = judge_comparability(*runs[i], reference);
    const std::string before = to_json(*records[i]);
    if (to_json(judged) == before) continue;
    const FolderLock lock(members[i].folder);
    const auto now = read_member(members[i].folder);
    if (!now || to_json(*now) != before) continue;  // another process ran the case again
    write_run(members[i].folder, judged);
  }
}

}  // namespace bb
