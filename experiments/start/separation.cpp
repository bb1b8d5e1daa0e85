#include "experiments/start/separation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/audit/enclosed.hpp"
#include "core/audit/state_audit.hpp"
#include "experiments/start/start_report.hpp"

namespace bb {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr int eighths = 8, halvings = 30;
constexpr std::size_t most_normals = 12, most_products = 24, most_directions = 60;

template <class Ids>
Ids columns_of(const Ids& all, const Tangle& tangle, int a, int b) {
  std::vector<int> kept;
  for (int i = 0; i < static_cast<int>(all.cols()); ++i) {
    const int c = tangle.component[static_cast<std::size_t>(all(0, i))];
    if (c == a || c == b) kept.push_back(i);
  }
  Ids out(all.rows(), static_cast<Eigen::Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) out.col(static_cast<Eigen::Index>(i)) = all.col(kept[i]);
  return out;
}

/// Two components and nothing else.
class Couple {
 public:
  Couple(const Tangle& tangle, int a, int b, const Positions& x)
      : tangle_(tangle), a_(a), x_(x), mesh_(tangle.mesh) {
    mesh_.edges = columns_of(mesh_.edges, tangle, a, b);
    mesh_.triangles = columns_of(mesh_.triangles, tangle, a, b);
    mesh_.obstacles.clear();
    for (std::size_t v = 0; v < tangle.component.size(); ++v) {
      const int c = tangle.component[v];
      if (c == a) of_a_.push_back(static_cast<int>(v));
      if (c == b) of_b_.push_back(static_cast<int>(v));
    }
    inside_ = most_inside(x);
  }

  const audit::AuditMesh& mesh() const { return mesh_; }

  /// Whether the two do not cross where a is shifted by that, and neither has come into the other.
  bool apart(const Vec3d& by) const {
    Positions x = x_;
    for (const int v : of_a_) x.col(v) += by;
    for (const audit::PairName& pair : audit::all_crossings(mesh_, x)) {
      const auto [first, second] = tangle_.components_of(pair);
      if (first != second) return false;
    }
    return inside_ || !most_inside(x);
  }

  /// The way along a direction after which the projections are apart, m.
  double way_of_projections(const Vec3d& n) const {
    double low = infinite, high = -infinite;
    for (const int v : of_a_) low = std::min(low, n.dot(x_.col(v)));
    for (const int v : of_b_) high = std::max(high, n.dot(x_.col(v)));
    return high - low;
  }

  Vec3d between_middles() const { return middle(of_a_) - middle(of_b_); }

 private:
  Vec3d middle(const std::vector<int>& vertices) const {
    Vec3d sum = Vec3d::Zero();
    for (const int v : vertices) sum += x_.col(v);
    return sum / static_cast<double>(vertices.size());
  }

  /// Whether more than half of the vertices of one of the two are inside the other, which is closed.
  bool most_inside(const Positions& x) const {
    return is_inside(x, of_a_, of_b_) || is_inside(x, of_b_, of_a_);
  }
  bool is_inside(const Positions& x, const std::vector<int>& of, const std::vector<int>& closed) const {
    audit::AuditMesh mesh = mesh_;
    std::vector<int> new_of(tangle_.component.size(), -1);
    int n = 0;
    Positions y(3, static_cast<Eigen::Index>(closed.size() + of.size()));
    for (const auto* list : {&closed, &of}) {
      for (const int v : *list) y.col(n) = x.col(v), new_of[static_cast<std::size_t>(v)] = n++;
    }
    for (int i = 0; i < static_cast<int>(mesh.triangles.size()); ++i) {
      int& v = mesh.triangles.data()[i];
      v = new_of[static_cast<std::size_t>(v)];
    }
    std::vector<int> vertices(of.size());
    for (std::size_t i = 0; i < of.size(); ++i) vertices[i] = static_cast<int>(closed.size() + i);
    const audit::ClosedBodies bodies(mesh, {0, static_cast<int>(closed.size())}, vertices);
    const auto found = bodies.enclosed(y).inside;
    const auto inside =
        std::count_if(found.begin(), found.end(), [](const auto& pair) { return pair.first == 0; });
    return 2 * static_cast<std::size_t>(inside) > of.size();
  }

  const Tangle& tangle_;
  int a_;
  const Positions& x_;
  audit::AuditMesh mesh_;
  std::vector<int> of_a_, of_b_;
  bool inside_ = false;
};

void add_direction(const Vec3d& n, std::vector<Vec3d>& out) {
  const double length = n.norm();
  if (!(length > 0) || out.size() >= most_directions) return;
  const Vec3d unit = n / length;
  const bool known =
      std::any_of(out.begin(), out.end(), [&](const Vec3d& o) { return o.dot(unit) > 1 - 1e-9; });
  if (known) return;
  out.push_back(unit);
  out.push_back(-unit);
}

std::vector<Vec3d> directions_of(const Tangle& tangle, const Couple& couple, const Positions& x) {
  std::vector<Vec3d> out, edges, sides;
  for (int k = 0; k < 3; ++k) add_direction(Vec3d::Unit(k), out);
  add_direction(couple.between_middles(), out);
  for (const audit::PairName& pair : audit::all_crossings(couple.mesh(), x)) {
    const auto [first, second] = tangle.components_of(pair);
    if (first == second || pair.kind != audit::PairKind::edge_triangle) continue;
    const auto v = vertices_of(couple.mesh(), pair);
    const auto at = [&](std::size_t i) { return Vec3d(x.col(v[i])); };
    if (out.size() < 2 * most_normals) {
      add_direction((at(3) - at(2)).cross(at(4) - at(2)), out);
      add_direction(at(1) - at(0), out);
    }
    for (std::size_t k = 0; k < 3 && out.size() < 2 * most_products; ++k)
      add_direction((at(1) - at(0)).cross(at(2 + (k + 1) % 3) - at(2 + k)), out);
  }
  return out;
}

/// The least way found along a direction, infinite where there is none below `most`.
double least_way(const Couple& couple, const Vec3d& n, double most) {
  const double all = couple.way_of_projections(n) * (1 + 1e-9) + 1e-12;
  if (!(all > 0)) return infinite;
  double low = 0, high = infinite;
  for (int k = 1; k <= eighths && low < most; ++k) {
    const double way = all * k / eighths;
    if (couple.apart(way * n)) {
      high = way;
      break;
    }
    low = way;
  }
  if (high == infinite) return infinite;
  for (int k = 0; k < halvings && high - low > 1e-7 * high; ++k) {
    const double middle = (low + high) / 2;
    (couple.apart(middle * n) ? high : low) = middle;
  }
  return high;
}

/// Shifts a component out of an obstacle by the deepest of its vertices; false where it cannot move.
bool leave_obstacle(const Tangle& tangle, int c, int o, Positions& x) {
  if (!tangle.movable(c)) return false;
  const Obstacle& given = tangle.scene.obstacles[static_cast<std::size_t>(o)];
  AnalyticSurface<double> obstacle = posed(analytic_surface<double>(given), x);
  double deepest = infinite;
  Vec3d normal = Vec3d::Zero(), middle = Vec3d::Zero();
  int n = 0;
  for (std::size_t v = 0; v < tangle.component.size(); ++v) {
    if (tangle.component[v] != c) continue;
    middle += x.col(static_cast<Eigen::Index>(v)), ++n;
    const SurfaceGap<double> gap = surface_gap<double>(obstacle, Vec3d(x.col(static_cast<Eigen::Index>(v))));
    if (gap.d < deepest) deepest = gap.d, normal = gap.normal;
  }
  if (given.kind != ObstacleKind::plane) normal = surface_gap<double>(obstacle, Vec3d(middle / n)).normal;
  if (normal.isZero(0)) normal = Vec3d::UnitZ();
  const double way = std::max(-deepest, 0.01 * tangle.mean_edge()) + tangle.widest_gap();
  for (std::size_t v = 0; v < tangle.component.size(); ++v) {
    if (tangle.component[v] == c) x.col(static_cast<Eigen::Index>(v)) += way * normal;
  }
  return true;
}

}  // namespace

std::vector<Shift> shifts_apart(const Tangle& tangle, int a, int b, const Positions& x) {
  const Couple couple(tangle, a, b, x);
  std::vector<Shift> out;
  double shortest = infinite;
  for (const Vec3d& n : directions_of(tangle, couple, x)) {
    const double way = least_way(couple, n, 3 * shortest);
    if (way == infinite) continue;
    out.push_back({n, way});
    shortest = std::min(shortest, way);
  }
  std::stable_sort(out.begin(), out.end(), [](const Shift& p, const Shift& q) { return p.way < q.way; });
  return out;
}

Positions shifted(const Tangle& tangle, int a, int b, const Shift& shift, const Positions& x) {
  const double m_a = tangle.component_mass[static_cast<std::size_t>(a)];
  const double m_b = tangle.component_mass[static_cast<std::size_t>(b)];
  const double part_a = !tangle.movable(b) ? 1 : !tangle.movable(a) ? 0 : m_b / (m_a + m_b);
  const double way = shift.way + 1.01 * tangle.widest_gap();
  Positions out = x;
  for (std::size_t v = 0; v < tangle.component.size(); ++v) {
    const auto i = static_cast<Eigen::Index>(v);
    if (tangle.component[v] == a) out.col(i) += part_a * way * shift.direction;
    if (tangle.component[v] == b) out.col(i) -= (1 - part_a) * way * shift.direction;
  }
  return out;
}

std::optional<Positions> separate(const Tangle& tangle, std::size_t rank) {
  Positions x = tangle.start();
  for (int round = 0; round < 8 * tangle.n_components + 8; ++round) {
    const auto crossings = audit::all_crossings(tangle.mesh, x);
    if (crossings.empty()) return x;
    const auto foreign = std::find_if(crossings.begin(), crossings.end(), [&](const audit::PairName& pair) {
      const auto [a, b] = tangle.components_of(pair);
      return a != b && (tangle.movable(a) || tangle.movable(b));
    });
    if (foreign == crossings.end()) return std::nullopt;
    const auto [a, b] = tangle.components_of(*foreign);
    if (b < 0) {
      if (!leave_obstacle(tangle, a, foreign->second, x)) return std::nullopt;
      continue;
    }
    const auto shifts = shifts_apart(tangle, a, b, x);
    const std::size_t taken = round == 0 ? rank : 0;
    if (taken >= shifts.size()) return std::nullopt;
    x = shifted(tangle, a, b, shifts[taken], x);
  }
  return std::nullopt;
}

std::optional<Positions> spread_out(const Tangle& tangle) {
  const auto n = static_cast<std::size_t>(tangle.n_components);
  std::vector<Vec3d> middle(n, Vec3d::Zero());
  std::vector<int> count(n, 0);
  for (std::size_t v = 0; v < tangle.component.size(); ++v) {
    const auto c = static_cast<std::size_t>(tangle.component[v]);
    middle[c] += tangle.start().col(static_cast<Eigen::Index>(v)), ++count[c];
  }
  Vec3d common = Vec3d::Zero();
  for (std::size_t c = 0; c < n; ++c) middle[c] /= count[c], common += middle[c] / static_cast<double>(n);
  const double size = tangle.mean_edge();
  for (std::size_t c = 0; c < n; ++c) {  // so that no two have one middle
    const double turn = 2.399963 * static_cast<double>(c),
                 up = (static_cast<double>(c) + 0.5) / static_cast<double>(n);
    middle[c] += 0.1 * size * Vec3d(std::cos(turn), std::sin(turn), 2 * up - 1);
  }
  const auto at = [&](double factor) {
    Positions x = tangle.start();
    for (std::size_t v = 0; v < tangle.component.size(); ++v) {
      const int c = tangle.component[v];
      if (tangle.movable(c))
        x.col(static_cast<Eigen::Index>(v)) += factor * (middle[static_cast<std::size_t>(c)] - common);
    }
    return x;
  };
  double low = 0, high = 0.125;
  while (!tangle.clean(at(high)) && high < 1024) low = high, high *= 2;
  if (high >= 1024) return std::nullopt;
  for (int k = 0; k < 12; ++k) (tangle.clean(at((low + high) / 2)) ? high : low) = (low + high) / 2;
  return at(high * 1.01);
}

}  // namespace bb
