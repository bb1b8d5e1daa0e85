#include "experiments/judge/judge.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>

#include "core/audit/audit.hpp"
#include "core/audit/enclosed.hpp"
#include "core/base/record/phase_times.hpp"
#include "core/math/error.hpp"
#include "experiments/judge/elastic_energies.hpp"
#include "experiments/judge/frame_stream.hpp"

namespace bb::judge {
namespace {

using Json = nlohmann::ordered_json;

constexpr int bins_a_decade = 4, decades = 6;  // of the histogram of gaps, up to the reach

/// null where nothing was within reach, or there is nothing to measure against.
Json metres(double value) { return std::isfinite(value) ? Json(value) : Json(); }

class Judge {
 public:
  explicit Judge(const Subject& subject)
      : subject_(subject),
        audit_(subject.mesh),
        closed_(audit_.mesh(), subject.names.first_vertex, audit_.vertices()),
        gap_counts_(bins_a_decade * decades + 1, 0) {
    if (subject.elastic) elastic_.emplace(*subject.elastic, subject.mesh.prescribed);
  }

  Json frame(const Positions& x) {
    const double start = now_s();
    const int number = static_cast<int>(frames_++);
    Json line = {{"frame", number}};
    add_state(x, number, line);
    if (number > 0) add_motion(x, number, line);
    if (x.allFinite()) {
      add_gaps(x, line);
      add_sides(x, line);
      add_energies(x, line);
    }
    last_ = x;
    seconds_ += now_s() - start;
    return line;
  }

  bool clean() const { return audit_.ledger().ok() && changed_sides_ == 0; }

  Json total() const {
    const audit::AuditLedger& found = audit_.ledger();
    Json out = {{"clean", clean()},
                {"frames", frames_},
                {"edges", found.subjects.edges},
                {"triangles", found.subjects.triangles},
                {"vertices", found.subjects.vertices},
                {"obstacles", found.subjects.obstacles},
                {"closed_bodies", names_of(closed_.bodies())},
                {"judged", found.judged()},
                {"state_pairs", found.state_pairs},
                {"motion_pairs", found.motion_pairs},
                {"obstacle_queries", found.obstacle_judged.total()},
                {"sides_asked", sides_asked_},
                {"crossings", found.crossings},
                {"touches", found.touches},
                {"passages", found.violations},
                {"unproven", found.unproven},
                {"obstacle_violations", found.obstacle_violations},
                {"changed_sides", changed_sides_},
                {"given_faults", found.scene_faults},
                {"inverted", found.inverted},
                {"not_finite", found.non_finite},
                {"self_test_passed", found.self_test_passed},
                {"audit_s", seconds_},
                {"gap_histogram", histogram()}};
    if (found.first_bad_step >= 0) out["first_bad_frame"] = found.first_bad_step;
    if (found.first_bad) out["first_bad"] = words(*found.first_bad);
    return out;
  }

 private:
  std::string words(const audit::PairName& pair) const {
    return audit::describe(audit_.mesh(), pair, subject_.names);
  }
  std::vector<std::string> names_of(const std::vector<int>& bodies) const {
    std::vector<std::string> out;
    for (const int b : bodies) out.push_back(subject_.names.bodies[static_cast<std::size_t>(b)]);
    return out;
  }

  void add_state(const Positions& x, int number, Json& line) {
    const audit::StateAudit found = audit_.check_state(x, number);
    line["finite"] = found.finite;
    line["crossings"] = found.crossings;
    line["touches"] = found.touches;
    line["obstacle_violations"] = found.obstacle_violations;
    line["given_faults"] = found.scene_faults;
    if (subject_.mesh.planar) line["inverted"] = found.inverted;
    if (found.first_bad) line["first"] = words(*found.first_bad);
    if (found.first_fault) line["first_given_fault"] = words(*found.first_fault);
    if (found.deepest) {
      line["deepest"] = words(*found.deepest);
      line["deepest_m"] = found.deepest_m;
    }
  }

  void add_energies(const Positions& x, Json& line) {
    if (!elastic_) return;
    line["elastic_J"] = elastic_->energies(x);
    line["work_of_given_J"] = elastic_->work_of_given(x);
  }

  void add_motion(const Positions& x, int number, Json& line) {
    const audit::MotionAudit found = audit_.check_motion(last_, x, number, subject_.tolerance_m);
    Json motion = {{"certified", found.certified},
                   {"passages", found.violations},
                   {"obstacle_violations", found.obstacle_violations},
                   {"unproven", found.unproven + found.obstacle_unproven}};
    if (found.first_bad) motion["first"] = words(*found.first_bad);
    line["motion"] = std::move(motion);
  }

  void add_gaps(const Positions& x, Json& line) {
    const audit::SurfaceGap gap = audit_.gap_of(x, subject_.reach_m);
    line["gap_between_m"] = metres(gap.between);
    line["gap_obstacles_m"] = metres(gap.to_obstacles);
    if (!(subject_.reach_m > 0)) return;
    for (const double g : gap.of_vertices) {
      if (std::isfinite(g)) ++gap_counts_[bin(g / subject_.reach_m)];
    }
  }
  /// Bin 0 has all below the lowest decade, and overlaps of thick surfaces.
  static std::size_t bin(double share) {
    if (!(share > 0)) return 0;
    const int k = static_cast<int>(std::floor((std::log10(share) + decades) * bins_a_decade)) + 1;
    return static_cast<std::size_t>(std::clamp(k, 0, bins_a_decade * decades));
  }
  /// Counts of vertices, over all frames, by their gap: each with the lower end of its bin, m.
  Json histogram() const {
    Json out = Json::array();
    for (std::size_t k = 0; k < gap_counts_.size(); ++k) {
      const double low = std::pow(10.0, (static_cast<double>(k) - 1) / bins_a_decade - decades);
      out.push_back(
          {{"from_m", k == 0 ? Json() : Json(low * subject_.reach_m)}, {"vertices", gap_counts_[k]}});
    }
    return out;
  }

  void add_sides(const Positions& x, Json& line) {
    if (closed_.bodies().empty()) return;
    audit::Enclosed now = closed_.enclosed(x);
    sides_asked_ += now.asked;
    line["inside"] = now.inside.size();
    if (sides_) {
      now.settle(*sides_);
      const auto changed = audit::changed_sides(*sides_, now);
      changed_sides_ += static_cast<long>(changed.size());
      line["changed_sides"] = changed.size();
      if (!changed.empty()) line["first_changed"] = words_of_side(changed.front());
    }
    add_depth(now, x, line);
    if (!first_sides_) first_sides_ = now;
    sides_ = std::move(now);
  }
  /// What is inside now and was not in the first frame: a body may hold another from the start.
  void add_depth(const audit::Enclosed& now, const Positions& x, Json& line) const {
    std::vector<audit::Enclosed::Pair> entered;
    const auto& from_the_start = first_sides_ ? first_sides_->inside : now.inside;
    std::set_difference(now.inside.begin(), now.inside.end(), from_the_start.begin(), from_the_start.end(),
                        std::back_inserter(entered));
    const std::vector<double> depths = closed_.depths(entered, x);
    const auto deepest = std::max_element(depths.begin(), depths.end());
    line["depth_bodies_m"] = deepest == depths.end() ? 0.0 : *deepest;
  }
  std::string words_of_side(const audit::Enclosed::Pair& pair) const {
    return "vertex " + subject_.names.vertices(std::array{pair.second}) + " is on the other side of " +
           subject_.names.bodies[static_cast<std::size_t>(pair.first)];
  }

  const Subject& subject_;
  audit::Audit audit_;
  audit::ClosedBodies closed_;
  std::optional<ElasticEnergies> elastic_;
  Positions last_;
  std::optional<audit::Enclosed> first_sides_, sides_;
  std::vector<long> gap_counts_;
  long frames_ = 0, changed_sides_ = 0, sides_asked_ = 0;
  double seconds_ = 0;
};

}  // namespace

Answer judge(const Subject& subject, std::istream& frames, std::ostream& out) {
  FrameStream stream(frames, subject.n_vertices);
  Judge judge(subject);
  Positions x;
  while (stream.next(x)) out << judge.frame(x).dump() << std::endl;
  if (stream.frames() == 0) throw ConfigError("standard input", "no frame", "at least one frame");
  out << Json{{"total", judge.total()}}.dump() << std::endl;
  return {judge.clean()};
}

}  // namespace bb::judge
