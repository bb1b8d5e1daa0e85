#include "core/audit/touch.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "core/audit/exact_integers.hpp"

namespace bb::audit {
namespace {

/// Sets of vertices that grow together.
class Patches {
 public:
  explicit Patches(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int of(int v) {
    while (parent_[static_cast<std::size_t>(v)] != v) {
      int& up = parent_[static_cast<std::size_t>(v)];
      up = parent_[static_cast<std::size_t>(up)];
      v = up;
    }
    return v;
  }
  void unite(int a, int b) {
    parent_[static_cast<std::size_t>(std::max(of(a), of(b)))] = std::min(of(a), of(b));
  }

 private:
  std::vector<int> parent_;
};

/// first + epsilon second for an infinitely small epsilon > 0; integers over a common power of two.
struct Moved {
  std::array<mpz_class, 3> at, by;
};
using Powers = std::array<mpz_class, 4>;  // coefficients of 1, epsilon, epsilon^2, epsilon^3

/// Sign of the first coefficient that is not zero.
int sign(const Powers& p) {
  for (const mpz_class& coefficient : p) {
    if (const int s = sgn(coefficient); s != 0) return s;
  }
  return 0;
}

struct Linear {
  mpz_class at, by;
};

/// p times (r.at + epsilon r.by), added to out.
void add_product(const Linear& p, const Linear& q, const Linear& r, int factor, Powers& out) {
  const mpz_class pq0 = p.at * q.at, pq1 = p.at * q.by + p.by * q.at, pq2 = p.by * q.by;
  out[0] += factor * pq0 * r.at;
  out[1] += factor * (pq0 * r.by + pq1 * r.at);
  out[2] += factor * (pq1 * r.by + pq2 * r.at);
  out[3] += factor * pq2 * r.by;
}

Linear difference(const Moved& a, const Moved& b, std::size_t k) {
  return {a.at[k] - b.at[k], a.by[k] - b.by[k]};
}

/// orient3d of displaced points.
int side(const Moved& a, const Moved& b, const Moved& c, const Moved& d) {
  std::array<std::array<Linear, 3>, 3> m;
  for (std::size_t k = 0; k < 3; ++k)
    m[0][k] = difference(b, a, k), m[1][k] = difference(c, a, k), m[2][k] = difference(d, a, k);
  Powers det;
  for (std::size_t k = 0; k < 3; ++k) {
    add_product(m[0][k], m[1][(k + 1) % 3], m[2][(k + 2) % 3], 1, det);
    add_product(m[0][k], m[1][(k + 2) % 3], m[2][(k + 1) % 3], -1, det);
  }
  return sign(det);
}

/// orient2d of displaced points.
int side(const Moved& a, const Moved& b, const Moved& c) {
  const Linear one{1, 0};
  Powers det;
  add_product(difference(b, a, 0), difference(c, a, 1), one, 1, det);
  add_product(difference(b, a, 1), difference(c, a, 0), one, -1, det);
  return sign(det);
}

/// True only if the closed primitives are apart once epsilon is small enough.
bool apart(const Moved& p, const Moved& q, const Moved& a, const Moved& b, const Moved& c) {
  const int side_p = side(a, b, c, p), side_q = side(a, b, c, q);
  if (side_p * side_q > 0) return true;
  const int s0 = side(p, q, a, b), s1 = side(p, q, b, c), s2 = side(p, q, c, a);
  // a triangle without area is its sides, and a line that is coplanar with none of them meets none
  if (side_p == 0 && side_q == 0) return s0 != 0 && s1 != 0 && s2 != 0;
  return std::min({s0, s1, s2}) < 0 && std::max({s0, s1, s2}) > 0;
}
bool apart(const Moved& p, const Moved& q, const Moved& a, const Moved& b) {
  return side(p, q, a) * side(p, q, b) > 0 || side(a, b, p) * side(a, b, q) > 0;
}

/// Off the axes by different amounts, so that no plane of constant coordinate contains one.
std::vector<std::array<int, 3>> directions(bool planar) {
  std::vector<std::array<int, 3>> out;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = planar ? 0 : -1; z <= (planar ? 0 : 1); ++z) {
        if (x != 0 || y != 0 || z != 0) out.push_back({64 * x + 3, 64 * y + 5, planar ? 0 : 64 * z + 7});
      }
    }
  }
  return out;
}

/// Two patches and the pairs in which they touch.
class PatchPair {
 public:
  PatchPair(const AuditMesh& mesh, const Positions& x, const std::vector<PairName>& pairs, Patches& patches)
      : mesh_(mesh), pairs_(pairs) {
    std::vector<int> vertices;
    for (const PairName& pair : pairs) {
      const std::vector<int> ids = ids_of(mesh, pair);
      vertices.insert(vertices.end(), ids.begin(), ids.end());
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    moving_ = patches.of(vertices.front());
    std::vector<double> raw;
    Vec3d lo = x.col(vertices.front()), hi = lo;
    for (const int v : vertices) {
      for (int k = 0; k < 3; ++k) raw.push_back(k == 2 && mesh.planar ? 0.0 : x(k, v));
      if (patches.of(v) == moving_) lo = lo.cwiseMin(x.col(v)), hi = hi.cwiseMax(x.col(v));
    }
    const Vec3d middle = 0.5 * lo + 0.5 * hi;
    for (int k = 0; k < 3; ++k) raw.push_back(k == 2 && mesh.planar ? 0.0 : middle[k]);
    const std::vector<mpz_class> z = to_integers(raw);
    for (std::size_t k = 0; k < 3; ++k) middle_[k] = z[z.size() - 3 + k];
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      Moved& m = points_[vertices[i]];
      for (std::size_t k = 0; k < 3; ++k) m.at[k] = z[3 * i + k];
      in_moving_[vertices[i]] = patches.of(vertices[i]) == moving_;
    }
  }

  static std::vector<int> ids_of(const AuditMesh& mesh, const PairName& pair) {
    std::vector<int> out{mesh.edges(0, pair.first), mesh.edges(1, pair.first)};
    if (mesh.planar) {
      out.insert(out.end(), {mesh.edges(0, pair.second), mesh.edges(1, pair.second)});
    } else {
      for (int k = 0; k < 3; ++k) out.push_back(mesh.triangles(k, pair.second));
    }
    return out;
  }

  bool separable() {
    for (const auto& direction : directions(mesh_.planar)) {
      displace([&](const Moved&, std::size_t k) { return mpz_class(direction[k]); });
      if (all_apart()) return true;
    }
    for (const int grow : {-1, 1}) {
      displace([&](const Moved& m, std::size_t k) { return mpz_class(grow * (m.at[k] - middle_[k])); });
      if (all_apart()) return true;
    }
    return false;
  }

 private:
  template <class F>
  void displace(F&& by) {
    for (auto& [v, m] : points_) {
      if (!in_moving_[v]) continue;
      for (std::size_t k = 0; k < 3; ++k) m.by[k] = by(m, k);
    }
  }
  bool all_apart() {
    for (const PairName& pair : pairs_) {
      const std::vector<int> v = ids_of(mesh_, pair);
      const bool free =
          mesh_.planar ? apart(points_[v[0]], points_[v[1]], points_[v[2]], points_[v[3]])
                       : apart(points_[v[0]], points_[v[1]], points_[v[2]], points_[v[3]], points_[v[4]]);
      if (!free) return false;
    }
    return true;
  }

  const AuditMesh& mesh_;
  const std::vector<PairName>& pairs_;
  int moving_ = 0;  // the patch that is displaced
  std::array<mpz_class, 3> middle_;
  std::map<int, Moved> points_;
  std::map<int, bool> in_moving_;
};

}  // namespace

std::vector<PairName> inseparable(const AuditMesh& mesh, const Positions& x, std::vector<PairName> touching) {
  std::vector<PairName> out;
  if (touching.empty()) return out;
  std::sort(touching.begin(), touching.end());
  Patches patches(static_cast<std::size_t>(x.cols()));
  const std::size_t first_of_second = 2;  // ids_of: the edge, then the other primitive
  for (const PairName& pair : touching) {
    const std::vector<int> v = PatchPair::ids_of(mesh, pair);
    patches.unite(v[0], v[1]);
    for (std::size_t k = first_of_second + 1; k < v.size(); ++k) patches.unite(v[first_of_second], v[k]);
  }
  std::map<std::pair<int, int>, std::vector<PairName>> groups;
  for (const PairName& pair : touching) {
    const std::vector<int> v = PatchPair::ids_of(mesh, pair);
    groups[std::minmax(patches.of(v[0]), patches.of(v[first_of_second]))].push_back(pair);
  }
  for (const auto& [between, pairs] : groups) {
    if (between.first != between.second && PatchPair(mesh, x, pairs, patches).separable()) continue;
    out.insert(out.end(), pairs.begin(), pairs.end());
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace bb::audit
