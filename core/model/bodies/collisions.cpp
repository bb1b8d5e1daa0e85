// What contact does with pairs of bodies: what was requested, and what `auto` makes of it (docs/theory/contact-models.md, Collision choice).
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "core/model/bodies/scene_builder.hpp"

namespace bb {
namespace {

/// Nothing where it follows from the surfaces.
std::optional<CollisionKind> given_kind(CollisionChoice choice) {
  switch (choice) {
    case CollisionChoice::ccd:
      return CollisionKind::ccd;
    case CollisionChoice::audited:
      return CollisionKind::audited;
    case CollisionChoice::static_test:
      return CollisionKind::static_test;
    case CollisionChoice::proximity:
      return CollisionKind::proximity;
    case CollisionChoice::off:
      return CollisionKind::off;
    case CollisionChoice::automatic:
      break;
  }
  return std::nullopt;
}

}  // namespace

void SceneBuilder::add_collision(const CollisionSpec& collision, const std::string& where) {
  collisions_.push_back(collision);
  collisions_at_.push_back(where_ + where);
}

std::string SceneBuilder::owner_name(int owner) const {
  const auto i = static_cast<std::size_t>(owner), n = scene_.bodies.size();
  return i < n ? scene_.bodies[i].name : scene_.obstacles[i - n].name;
}

/// -1 after a violation. An obstacle that moves has a body of its name behind those with a mesh: it is the obstacle that is meant.
int SceneBuilder::owner(const std::string& name, const std::string& where) {
  const int n = static_cast<int>(scene_.bodies.size());
  std::string names;
  for (int o = 0; o < n + static_cast<int>(scene_.obstacles.size()); ++o) {
    if (o < n && static_cast<std::size_t>(o) >= closed_.size()) continue;
    if (owner_name(o) == name) return o;
    names += (names.empty() ? "" : ", ") + owner_name(o);
  }
  violations_.push_back({where, '"' + name + '"', "the name of a body or an obstacle: " + names});
  return -1;
}

bool SceneBuilder::can_move(int owner) const {
  if (static_cast<std::size_t>(owner) >= scene_.bodies.size()) return false;
  const Body& body = scene_.bodies[static_cast<std::size_t>(owner)];
  const auto begin = held_.begin() + body.first_vertex;
  return std::any_of(begin, begin + body.n_vertices, [](int pin) { return pin < 0; });
}

bool SceneBuilder::has_triangles(int owner) const {
  if (static_cast<std::size_t>(owner) >= scene_.bodies.size())
    return true;  // an obstacle states by itself what is inside
  return std::any_of(scene_.surface_triangles.begin(), scene_.surface_triangles.end(),
                     [&](const auto& t) { return scene_.body[static_cast<std::size_t>(t[0])] == owner; });
}

/// Two closed surfaces of which one passes wholly through the other intersect on the way for as long as a body is thick; an open one
/// may be on either side of another in two states without having intersected it in either. Whether it passed
/// shows in the motion of a step, once it is over.
CollisionPair SceneBuilder::decide(const CollisionSpec& spec, int a, int b) const {
  const auto [first, second] = std::minmax(a, b);
  if (const auto kind = given_kind(spec.choice)) return {first, second, *kind, "as given"};
  const auto closed = [&](int owner) {
    return static_cast<std::size_t>(owner) >= closed_.size() || closed_[static_cast<std::size_t>(owner)] != 0;
  };
  if (scene_.planar) return {first, second, CollisionKind::ccd, "auto: the scene is planar"};
  if (first == second) return decide_open(first, second, "auto: a body and itself are as two open surfaces");
  for (const int owner : {first, second}) {
    if (!closed(owner))
      return decide_open(first, second, fmt::format("auto: the surface of {} is open", owner_name(owner)));
  }
  return {first, second, CollisionKind::static_test, "auto: both surfaces are closed"};
}

CollisionPair SceneBuilder::decide_open(int first, int second, const std::string& why) const {
  if (unbounded_by_.empty()) return {first, second, CollisionKind::audited, why};
  return {first, second, CollisionKind::ccd,
          fmt::format("{}; the step solver {} bounds no motion", why, unbounded_by_)};
}

/// Whether the pair can be of its kind; else it is a violation.
bool SceneBuilder::allows(const CollisionPair& pair, const std::string& where) {
  if (pair.kind == CollisionKind::audited && !unbounded_by_.empty()) {
    violations_.push_back({where + "/kind", "audited",
                           fmt::format("another kind: the step solver {} bounds no motion, so a step that is "
                                       "done again would pass through as before",
                                       unbounded_by_)});
    return false;
  }
  const bool obstacle = pair.second >= static_cast<int>(scene_.bodies.size());
  const bool testable =
      obstacle || (!scene_.planar && (has_triangles(pair.first) || has_triangles(pair.second)));
  if (pair.kind != CollisionKind::static_test || testable) return true;
  violations_.push_back(
      {where + "/kind", "static",
       scene_.planar ? "another kind: the scene is planar" : "another kind: neither surface has a triangle"});
  return false;
}

void SceneBuilder::append_collisions() {
  append_groups();
  Collisions& out = scene_.collisions;
  for (std::size_t i = 0; i < collisions_.size(); ++i) {
    const CollisionSpec& spec = collisions_[i];
    const std::string& where = collisions_at_[i];
    const int a = owner(spec.a, where + "/a"), b = owner(spec.b, where + "/b");
    if (a < 0 || b < 0) continue;
    const CollisionPair pair = decide(spec, a, b);
    if (!can_move(a) && !can_move(b)) {
      violations_.push_back({where, fmt::format("{} and {}", spec.a, spec.b),
                             "a pair of which one has a vertex that moves freely: others have no contact"});
      continue;
    }
    if (!allows(pair, where)) continue;
    if (std::any_of(out.pairs.begin(), out.pairs.end(), [&pair](const CollisionPair& other) {
          return other.first == pair.first && other.second == pair.second;
        })) {
      violations_.push_back({where, fmt::format("{} and {} once more", spec.a, spec.b), "every pair once"});
      continue;
    }
    out.pairs.push_back(pair);
  }
  std::sort(out.pairs.begin(), out.pairs.end(), [](const CollisionPair& one, const CollisionPair& other) {
    return std::tie(one.first, one.second) < std::tie(other.first, other.second);
  });
}

/// Groups by number, in the order in which bodies and obstacles name them.
void SceneBuilder::append_groups() {
  std::map<std::string, int> numbers;
  std::vector<int> group(scene_.bodies.size() + scene_.obstacles.size(), -1);
  const auto put = [&](std::size_t owner, const std::string& name) {
    if (name.empty()) return;
    group[owner] = numbers.emplace(name, static_cast<int>(numbers.size())).first->second;
  };
  for (std::size_t i = 0; i < groups_.size(); ++i) put(i, groups_[i]);
  for (std::size_t i = 0; i < scene_.obstacles.size(); ++i) {
    put(scene_.bodies.size() + i, scene_.obstacles[i].collision_group);
  }
  if (!numbers.empty()) scene_.collisions.group = std::move(group);
}

}  // namespace bb
