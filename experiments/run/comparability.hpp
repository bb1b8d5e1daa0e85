// Which runs of a sweep may be compared with each other. Computed here and nowhere else: the record keeps the
// verdict, and tables and figures read it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "core/base/record/run_record.hpp"

namespace bb {

/// What the comparison reads of a record.
struct ComparedRun {
  std::string folder;  // its name beside the other runs
  std::string run_id, outcome, shape, argument, matching_rule;
  bool valid = false;
  Number gap_rel;      // smallest d/d_hat over converged step ends; missing without contact
  GapMap gaps;         // of every pair of bodies with load at converged step ends
  std::string failed;  // names of the validity checks that failed, joined by ", "
};
ComparedRun compared_run(const RunRecord& record, const std::filesystem::path& folder);

/// The rule. not_valid: the run is not valid, so that nothing of it is compared. no_reference: there is none, or it is not
/// valid, or no contact of it carries load at a converged step end. Otherwise comparable exactly if every load-weighted
/// quantile of the gap (d/d_hat; 5 %, 50 %, 95 %) of every pair of bodies is within a factor 2 of the reference's:
/// barriers that keep their contacts at other distances do different work. A pair counts that has, in one of the two runs,
/// at least 1 % of the load or load in 10 % of the time; where it has none its gaps are at least d_hat and count as 1. Where no
/// pair has that much all count. A quantile at or below 0, of surfaces that overlap, is within no factor of another run's.
/// @param reference the run itself may be its own reference; without a run_id it is one that left no record
Comparability judge_comparability(const ComparedRun& run, const std::optional<ComparedRun>& reference);

/// A case of a sweep: its folder, the index of its reference where the sweep's file marks one, and the number
/// of the scene, step length and so on that it shares with the cases it may be compared with.
struct SweepMember {
  std::filesystem::path folder;
  std::optional<std::size_t> reference;
  std::size_t group = 0;
  bool ran = true;  // false: the case was refused, and a record in its folder is of an earlier sweep
};

/// Without a mark in the sweep's file: of the members of the same group the first valid run in contact with
/// the log barrier on the gap and the same matching rule; else the first valid run in contact; else none.
/// runs: one a member.
std::optional<std::size_t> default_reference(std::span<const SweepMember> members,
                                             std::span<const std::optional<ComparedRun>> runs,
                                             std::size_t index);

/// Writes `comparability` into every record of the sweep, those of earlier runs too, each as a whole and with
/// its folder locked; a record that says the same already is left alone, and so is one that changed since it
/// was read. Folders without a readable record are passed over. Errors: RecordError, also where another
/// process holds a folder.
void write_comparability(std::span<const SweepMember> members);

}  // namespace bb
