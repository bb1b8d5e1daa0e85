#include "experiments/run/comparability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "core/base/record/folder_lock.hpp"
#include "core/base/record/writer.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

bool has_load(const ComparedRun& run) { return !run.gaps.empty(); }

// Shares are sums over steps: a tenth of the steps is a tenth up to rounding.
constexpr double least_load_share = 0.01, least_time_share = 0.1 * (1 - 1e-9);
constexpr const char* overlap = "overlap";

bool counts(const GapMap& gaps, const std::string& pair) {
  const auto found = gaps.find(pair);
  if (found == gaps.end()) return false;
  return found->second.load_share >= least_load_share || found->second.time_share >= least_time_share;
}

struct Quantile {
  const char *field, *words;
  double PairGaps::*value;
};
constexpr Quantile quantiles[] = {{"gap_rel_p05", "5 % quantile", &PairGaps::gap_rel_p05},
                                  {"gap_rel_median", "median", &PairGaps::gap_rel_median},
                                  {"gap_rel_p95", "95 % quantile", &PairGaps::gap_rel_p95}};

/// 1 without load: from there on the barrier carries nothing.
double quantile_of(const GapMap& gaps, const std::string& pair, const Quantile& quantile) {
  const auto found = gaps.find(pair);
  return found == gaps.end() ? 1 : found->second.*quantile.value;
}

/// Those that count, or all where loads are spread over so many pairs that none does.
std::set<std::string> compared_pairs(const GapMap& run, const GapMap& reference) {
  std::set<std::string> all, out;
  for (const GapMap* gaps : {&reference, &run}) {
    for (const auto& [pair, of] : *gaps) {
      all.insert(pair);
      if (counts(*gaps, pair)) out.insert(pair);
    }
  }
  return out.empty() ? all : out;
}

/// Of a gap at or below 0 nothing is within a factor, but in one and the same run.
Number ratio_of(double mine, double other, bool itself) {
  if (mine > 0 && other > 0) return mine / other;
  return itself && mine == other ? Number(1.0) : Number::missing(overlap);
}

/// The pair and the quantile that disagree most; among equals the first. Requires a pair.
const Quantile& compare_pairs(const GapMap& run, const GapMap& reference, bool itself, Comparability& out) {
  const Quantile* farthest = &quantiles[0];
  double most = -1;
  for (const std::string& pair : compared_pairs(run, reference)) {
    for (const Quantile& quantile : quantiles) {
      const double mine = quantile_of(run, pair, quantile), other = quantile_of(reference, pair, quantile);
      const Number ratio = ratio_of(mine, other, itself);
      const double apart =
          ratio.finite() ? std::abs(std::log(ratio.value)) : std::numeric_limits<double>::infinity();
      if (apart <= most) continue;
      most = apart;
      farthest = &quantile;
      out.pair = pair;
      out.pair_quantile = quantile.field;
      out.pair_gap_rel = mine;
      out.pair_reference_gap_rel = other;
      out.pair_ratio = ratio;
    }
  }
  return *farthest;
}

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

std::string reason_of(const Comparability& c, const Quantile& quantile, bool comparable) {
  if (!c.pair_ratio.finite()) {
    return fmt::format(
        "{} of the gap, {}: {:.3g} d_hat where the reference has {:.3g}: surfaces overlap, and no factor is "
        "between such gaps",
        quantile.words, c.pair, c.pair_gap_rel.value, c.pair_reference_gap_rel.value);
  }
  return fmt::format("{} of the gap, {}: {:.3g} d_hat where the reference has {:.3g}, {} a factor {:g}",
                     quantile.words, c.pair, c.pair_gap_rel.value, c.pair_reference_gap_rel.value,
                     comparable ? "the most, within" : "beyond", c.max_ratio);
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
  out.gaps = record.summary.contact_gaps;
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
  out.pair_gap_rel = out.pair_reference_gap_rel = out.pair_ratio = Number::missing("no_reference");
  const bool usable = reference && reference->valid && has_load(*reference);
  if (usable && run.gap_rel.finite()) out.ratio = run.gap_rel.value / reference->gap_rel.value;
  if (!run.valid) {
    out.verdict = "not_valid";
    out.reason = "the run is not valid: " + fault_of(run);
  } else if (!reference) {
    out.verdict = "no_reference";
    out.reason = "no valid run of a finished sweep to compare with";
  } else if (!usable) {
    out.verdict = "no_reference";
    out.reason = reference->valid ? "no contact of the reference carries load at the end of a converged step"
                                  : "the reference is not valid: " + fault_of(*reference);
  } else if (!has_load(run)) {
    out.verdict = "not_comparable";
    out.reason = "no contact with load at the end of a converged step, where the reference has some";
    out.pair_gap_rel = out.pair_reference_gap_rel = out.pair_ratio = Number::missing("no_contacts");
  } else {
    const bool itself = run.folder == reference->folder;
    const Quantile& quantile = compare_pairs(run.gaps, reference->gaps, itself, out);
    const double ratio = out.pair_ratio.value;
    const bool comparable = out.pair_ratio.finite() && ratio >= 1 / out.max_ratio && ratio <= out.max_ratio;
    out.verdict = comparable ? "comparable" : "not_comparable";
    out.reason = itself ? "the reference itself" : reason_of(out, quantile, comparable);
  }
  return out;
}

std::optional<std::size_t> default_reference(std::span<const SweepMember> members,
                                             std::span<const std::optional<ComparedRun>> runs,
                                             std::size_t index) {
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (members[i].group != members[index].group) continue;
    if (!runs[i] || !runs[i]->valid || !has_load(*runs[i])) continue;
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
