// What contact does with a pair of bodies (docs/theory/contact-models.md, Collision choice). An owner is a body by its number or, behind all
// bodies, an obstacle.
#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace bb {

/// What is required of a pair.
enum class CollisionKind : std::uint8_t {
  ccd,      // rows, and no motion goes beyond a bound that is proven free of contact
  audited,  // rows, and the straight motion of a step is proven free of contact when it is over, or the step
            // is done again as if the pair were `ccd`
  static_test,  // rows, and no state is accepted in which the surfaces of the pair intersect
  proximity,    // rows: forces where the pair is near
  off           // nothing
};

/// Some of them.
class CollisionKinds {
 public:
  constexpr CollisionKinds(std::initializer_list<CollisionKind> kinds) {
    for (const CollisionKind kind : kinds) bits_ |= bit(kind);
  }
  constexpr bool has(CollisionKind kind) const { return (bits_ & bit(kind)) != 0; }

 private:
  static constexpr unsigned bit(CollisionKind kind) { return 1U << static_cast<unsigned>(kind); }
  unsigned bits_ = 0;
};

/// A pair that the scene states something of.
struct CollisionPair {
  int first = 0, second = 0;  // owners, first <= second
  CollisionKind kind = CollisionKind::ccd;
  std::string reason;  // one clause
};

/// Pairs that none of these speaks of collide as `ccd`.
struct Collisions {
  std::vector<int> group;            // [owners] -1: of none; empty: nobody is of a group
  std::vector<CollisionPair> pairs;  // ascending, each once

  /// False where all pairs collide as `ccd`.
  bool chosen() const { return !group.empty() || !pairs.empty(); }
  /// The entry of a pair of owners; null: it has none.
  const CollisionPair* find(int a, int b) const {
    const auto key = std::minmax(a, b);
    const auto found =
        std::lower_bound(pairs.begin(), pairs.end(), key, [](const CollisionPair& p, const auto& k) {
          return std::tie(p.first, p.second) < std::tie(k.first, k.second);
        });
    return found != pairs.end() && found->first == key.first && found->second == key.second ? &*found
                                                                                            : nullptr;
  }
  /// Both are of a group, and of different ones.
  bool apart_by_group(int a, int b) const {
    if (group.empty()) return false;
    const int one = group[static_cast<std::size_t>(a)], other = group[static_cast<std::size_t>(b)];
    return one >= 0 && other >= 0 && one != other;
  }
  /// Cost: O(log pairs).
  CollisionKind kind(int a, int b) const {
    if (const CollisionPair* pair = find(a, b)) return pair->kind;
    return apart_by_group(a, b) ? CollisionKind::off : CollisionKind::ccd;
  }
  /// Whether some pair is of that kind, `off` by its group apart.
  bool has(CollisionKind kind) const {
    return std::any_of(pairs.begin(), pairs.end(), [kind](const CollisionPair& p) { return p.kind == kind; });
  }
};

}  // namespace bb
