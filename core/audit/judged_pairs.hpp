// Which pairs of bodies and obstacles are judged within steps, and which at their ends alone.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

namespace bb::audit {

/// What a judge looks at: all pairs, or those that it has to judge in the states and motions within steps, or
/// those in the state at the end of a step and in the straight motion of the whole step.
enum class Scope { all, within_steps, at_step_ends };

/// Plain data. An owner is a body by its number or, behind all bodies, an obstacle.
struct JudgedPairs {
  std::vector<int> owner;  // [n_vertices] or empty: all pairs are judged within steps
  int n_bodies = 0;        // obstacle o is the owner n_bodies + o
  std::vector<std::array<int, 2>>
      late;  // judged at the ends of steps alone; ascending, the lower owner first

  Scope scope = Scope::all;
  std::vector<char> asked;  // [n_bodies] or empty: whether a body has a pair with a body in the scope

  bool of_owners(int a, int b) const {
    const auto pair = std::minmax(a, b);
    const std::array key{pair.first, pair.second};
    return std::binary_search(late.begin(), late.end(), key) == (scope == Scope::at_step_ends);
  }
  /// Whether the scope has pairs of the bodies of two vertices.
  bool of_vertices(int v, int w) const { return scope == Scope::all || of_owners(of(v), of(w)); }
  /// The same of a vertex and an obstacle.
  bool at_obstacle(int v, int obstacle) const {
    return scope == Scope::all || of_owners(of(v), n_bodies + obstacle);
  }
  /// Whether the scope has a pair of the vertex and the surface of some body.
  bool asks(int v) const { return asked.empty() || asked[static_cast<std::size_t>(of(v))] != 0; }

  /// Of the same bodies in a scope. vertices: of the surface.
  JudgedPairs in(Scope other, const std::vector<int>& vertices) const {
    JudgedPairs out = *this;
    out.scope = other;
    out.asked.assign(static_cast<std::size_t>(n_bodies), 0);
    std::vector<int> bodies;
    bodies.reserve(vertices.size());
    for (const int v : vertices) bodies.push_back(of(v));
    std::sort(bodies.begin(), bodies.end());
    bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
    for (const int a : bodies) {
      out.asked[static_cast<std::size_t>(a)] =
          std::any_of(bodies.begin(), bodies.end(), [&](int b) { return out.of_owners(a, b); });
    }
    return out;
  }

 private:
  int of(int v) const { return owner[static_cast<std::size_t>(v)]; }
};

}  // namespace bb::audit
