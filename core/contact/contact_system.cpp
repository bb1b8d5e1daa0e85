// The state of a run's contact geometry, and the loops over its candidates.
#include "core/contact/contact_system.hpp"

#include <algorithm>
#include <optional>

#include "core/contact/candidates.hpp"
#include "core/contact/chunks.hpp"
#include "core/contact/pair_motion.hpp"
#include "core/contact/row_builder.hpp"

namespace bb {

namespace {

std::vector<AnalyticSurface<double>> analytic_surfaces(const Scene& scene) {
  std::vector<AnalyticSurface<double>> out;
  for (const Obstacle& o : scene.obstacles) out.push_back(analytic_surface<double>(o));
  return out;
}

template <PairKind K>
constexpr ContactKind contact_kind() {
  constexpr ContactKind kinds[] = {ContactKind::point_point, ContactKind::point_edge,
                                   ContactKind::point_triangle, ContactKind::edge_edge};
  return kinds[static_cast<int>(K)];
}

template <std::size_t N>
ContactKey pair_key(const std::array<int, N>& vertex) {
  std::array<int, 4> padded{-1, -1, -1, -1};
  std::copy(vertex.begin(), vertex.end(), padded.begin());
  return contact_key(padded);
}

/// The earlier bound limits; on a tie the first in the order of the candidates. Counters add up.
void combine_bounds(StepBound& into, const StepBound& next) {
  if (next.alpha < into.alpha) {
    into.alpha = next.alpha;
    into.kind = next.kind;
    into.key = next.key;
  }
  into.queries += next.queries;
  into.probes += next.probes;
  into.capped += next.capped;
  into.zero += next.zero;
}

}  // namespace

struct ContactSystem::Data {
  Data(const Scene& s, const ContactOptions& o, const ContactPlan& plan)
      : scene(s),
        options(o),
        surface(s),
        obstacles(analytic_surfaces(s)),
        broad_phase(surface, obstacles, plan),
        builder(scene, surface, obstacles, o.mollifier) {}

  template <PairKind K>
  void bound_pair(const Positions& x0, const Positions& x1, IndexPair index, StepBound& out) const;
  void bound_obstacle(const Positions& x0, const Positions& x1, IndexPair index, StepBound& out) const;
  template <PairKind K>
  std::optional<Overlap> pair_overlap(const Positions& x, IndexPair index) const;
  std::optional<Overlap> obstacle_overlap(const Positions& x, IndexPair index) const;
  std::optional<Overlap> first_overlap(const Positions& x) const;

  /// Runs add(pair, result) over all pairs in chunks and reduce(result) over the chunks in order.
  template <class Result, class Add, class Reduce>
  static void over(const std::vector<IndexPair>& pairs, const Add& add, const Reduce& reduce) {
    std::vector<Result> results(n_chunks(pairs.size()));
    for_each_chunk(pairs.size(), [&](std::size_t k, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) add(pairs[i], results[k]);
    });
    for (const Result& r : results) reduce(r);
  }

  const Scene& scene;
  const ContactOptions options;
  const Surface surface;
  const std::vector<AnalyticSurface<double>> obstacles;
  BroadPhase broad_phase;
  Candidates candidates;
  RowBuilder builder;
};

template <PairKind K>
void ContactSystem::Data::bound_pair(const Positions& x0, const Positions& x1, IndexPair index,
                                     StepBound& out) const {
  const ContactPair<K> pair = contact_pair<K>(surface, index);
  const auto p0 = gather(x0, pair.vertex), p1 = gather(x1, pair.vertex);
  const double park = options.ccd_park * pair.law.d_hat;
  if (proven_apart<K>(p0, p1, pair.law.offset, park)) return;
  const AccdResult<double> r = pair_toi<K>(p0, p1, pair.law.offset, park, options.ccd_max_probes);
  const double toi = r.hit ? r.toi : 1;
  StepBound one{toi, contact_kind<K>(), pair_key(pair.vertex), 1, r.probes, r.capped, toi == 0};
  combine_bounds(out, one);
}

void ContactSystem::Data::bound_obstacle(const Positions& x0, const Positions& x1, IndexPair index,
                                         StepBound& out) const {
  const std::size_t i = static_cast<std::size_t>(index.first);
  const int v = surface.points.vertices[i][0];
  const Side law = surface.points.side[i];
  const double toi = obstacle_toi(obstacles[static_cast<std::size_t>(index.second)], x0.col(v), x1.col(v),
                                  law.offset, options.ccd_park * law.d_hat);
  combine_bounds(out, {toi, ContactKind::obstacle, {-1, -1, -2 - index.second, v}, 0, 0, 0, toi == 0});
}

template <PairKind K>
std::optional<ContactSystem::Overlap> ContactSystem::Data::pair_overlap(const Positions& x,
                                                                        IndexPair index) const {
  const ContactPair<K> pair = contact_pair<K>(surface, index);
  const auto points = gather(x, pair.vertex);
  if (farther_than<K>(points, pair.law.offset)) return std::nullopt;
  const double gap = closest_points<K, double>(points).d - pair.law.offset;
  if (gap > 0) return std::nullopt;
  return Overlap{contact_kind<K>(), pair_key(pair.vertex), gap, {}};
}

std::optional<ContactSystem::Overlap> ContactSystem::Data::obstacle_overlap(const Positions& x,
                                                                            IndexPair index) const {
  const std::size_t i = static_cast<std::size_t>(index.first);
  const int v = surface.points.vertices[i][0];
  const double gap = surface_gap<double>(obstacles[static_cast<std::size_t>(index.second)], x.col(v)).d -
                     surface.points.side[i].offset;
  if (gap > 0) return std::nullopt;
  return Overlap{ContactKind::obstacle, {-1, -1, -2 - index.second, v}, gap, {}};
}

std::optional<ContactSystem::Overlap> ContactSystem::Data::first_overlap(const Positions& x) const {
  std::optional<Overlap> first;
  const auto scan = [&](const std::vector<IndexPair>& pairs, const auto& test) {
    over<std::optional<Overlap>>(
        pairs,
        [&](IndexPair pair, std::optional<Overlap>& found) {
          if (!found) found = test(pair);
        },
        [&](const std::optional<Overlap>& found) {
          if (!first) first = found;
        });
  };
  for_each_kind(candidates, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
    scan(pairs, [&](IndexPair pair) { return pair_overlap<K>(x, pair); });
  });
  scan(candidates.obstacle, [&](IndexPair pair) { return obstacle_overlap(x, pair); });
  return first;
}

ContactSystem::ContactSystem(const Scene& scene, const ContactOptions& options, const ContactPlan& plan)
    : data_(std::make_unique<Data>(scene, options, plan)) {}
ContactSystem::ContactSystem(const Scene& scene, const ContactOptions& options)
    : ContactSystem(scene, options, plan_contact(scene)) {}
ContactSystem::~ContactSystem() = default;

bool ContactSystem::active() const { return data_->broad_phase.active(); }

void ContactSystem::update_candidates(const Positions& x0, const Positions& x1) {
  if (active()) data_->broad_phase.update(x0, x1, data_->candidates);
}

double ContactSystem::find_rows(const Positions& x, ContactTable& rows, MollifiedTable& mollified) const {
  return data_->builder.build(x, data_->candidates, rows, mollified);
}

StepBound ContactSystem::step_bound(const Positions& x0, const Positions& x1) const {
  const Data& data = *data_;
  StepBound bound;
  if (!(x0.allFinite() && x1.allFinite())) {
    bound.alpha = 0;
    return bound;
  }
  const auto reduce = [&](const StepBound& part) { combine_bounds(bound, part); };
  for_each_kind(data.candidates, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
    Data::over<StepBound>(
        pairs, [&](IndexPair pair, StepBound& out) { data.bound_pair<K>(x0, x1, pair, out); }, reduce);
  });
  Data::over<StepBound>(
      data.candidates.obstacle,
      [&](IndexPair pair, StepBound& out) { data.bound_obstacle(x0, x1, pair, out); }, reduce);
  return bound;
}

ContactSystem::Counts ContactSystem::candidate_counts() const {
  const Candidates& c = data_->candidates;
  return {c.point_triangle.size(), c.edge_edge.size(), c.point_point.size(), c.point_edge.size(),
          c.obstacle.size()};
}

std::optional<ContactSystem::Overlap> ContactSystem::check_initial(const Positions& x) {
  update_candidates(x, x);
  std::optional<Overlap> found = data_->first_overlap(x);
  if (found) found->text = describe(found->key, found->kind);
  return found;
}

std::string ContactSystem::describe(const ContactKey& key, ContactKind kind) const {
  constexpr const char* names[] = {"point_point", "point_edge", "point_triangle", "edge_edge", "obstacle"};
  const Scene& scene = data_->scene;
  std::string out = names[static_cast<int>(kind)];
  const char* separator = ": ";
  for (int id : key) {
    if (id == -1) continue;
    out += separator;
    separator = ", ";
    if (id < -1) {
      const std::size_t o = static_cast<std::size_t>(-2 - id);
      out += scene.obstacles[o].name.empty() ? "obstacle " + std::to_string(o) : scene.obstacles[o].name;
      continue;
    }
    const Body& body = scene.bodies[static_cast<std::size_t>(scene.body[static_cast<std::size_t>(id)])];
    out += body.name + "[" + std::to_string(id - body.first_vertex) + "]";
  }
  return out;
}

}  // namespace bb
