#include "experiments/run/validity.hpp"

#include <algorithm>
#include <optional>
#include <string>

namespace bb {
namespace {

void add_check(RunRecord& record, const char* name, double value, double bound, bool pass) {
  record.validity.checks.push_back({name, value, bound, pass});
}

// The largest stretch that any limited element may have, minus 1; 0 without a limit.
double hard_limit(const Scene& scene) {
  double largest = 0;
  for (const StrainBands* bands :
       {static_cast<const StrainBands*>(&scene.limit), static_cast<const StrainBands*>(&scene.solid_limit)}) {
    for (std::size_t e = 0; e < bands->width.size(); ++e) {
      largest = std::max(largest, bands->onset[e] + bands->width[e]);
    }
  }
  return largest;
}

// Steps that ended in a saddle or at a cusp; nothing where no end of a step was looked at.
std::optional<int> saddle_ends(const CountMap& proofs) {
  const auto count = [&proofs](EndProof proof) {
    const auto found = proofs.find(std::string(to_string(proof)));
    return found == proofs.end() ? 0 : found->second;
  };
  const int saddles = count(EndProof::saddle) + count(EndProof::cusp);
  if (saddles + count(EndProof::factor) + count(EndProof::lanczos) == 0) return std::nullopt;
  return saddles;
}

}  // namespace

void fill_validity(const Scene& scene, const audit::AuditLedger* ledger, const std::string& hash_time,
                   const std::string& hash_seen, RunRecord& record) {
  if (ledger) {
    const long among = ledger->only_points ? 0 : ledger->crossings + ledger->violations;
    const long open = ledger->only_points ? ledger->obstacle_unproven : ledger->unproven;
    const auto found = static_cast<double>(among + open + ledger->obstacle_violations + ledger->scene_faults +
                                           ledger->non_finite + ledger->unjudged);
    add_check(record, "audit_clean", found, 0.0, ledger->clean());
    add_check(record, "audit_judged", static_cast<double>(ledger->judged()), 1.0, ledger->judged() > 0);
  }
  if (!hash_time.empty() && !hash_seen.empty()) {
    const bool same = hash_time == hash_seen;
    add_check(record, "state_hash_equal_in_all_passes", same ? 0.0 : 1.0, 0.0, same);
  }
  if (const double limit = hard_limit(scene); limit > 0 && record.summary.max_stretch.finite()) {
    const double stretch = record.summary.max_stretch.value;
    add_check(record, "strain_limit_kept", stretch, limit, stretch < limit);
  }
  if (const std::optional<int> saddles = saddle_ends(record.summary.end_proofs)) {
    add_check(record, "no_saddle", *saddles, 0.0, *saddles == 0);
  }
  if (const BuildValidity& build = record.validity.build; build.checks > 0) {
    add_check(record, "build_valid", build.valid ? 0.0 : 1.0, 0.0, build.valid);
  }
  const bool ok = record.status.outcome == Outcome::ok;
  add_check(record, "outcome_ok", ok ? 0.0 : 1.0, 0.0, ok);
  record.validity.valid = std::all_of(record.validity.checks.begin(), record.validity.checks.end(),
                                      [](const Check& check) { return check.pass; });
  record.status.valid = record.validity.valid;
}

}  // namespace bb
