#include "experiments/start/contour.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/audit/state_audit.hpp"
#include "experiments/start/start_report.hpp"

namespace bb {
namespace {

/// One edge through one triangle.
struct Piercing {
  std::array<int, 5> v{};      // edge, then triangle
  Vec3d p, along, normal;      // m; E; not of length 1
  double t = 0;                // p = a + t E
  Vec3d part;                  // barycentric, of the triangle
  Vec3d pull = Vec3d::Zero();  // gradient of the length in p
  int segments = 0;
};

constexpr double least_slope = 0.05;  // of N . E over |N| |E|: below it p runs far for a small change

Piercing piercing_of(const std::vector<int>& vertices, const Positions& x) {
  Piercing out;
  std::copy_n(vertices.begin(), 5, out.v.begin());
  const Vec3d a = x.col(out.v[0]), c = x.col(out.v[2]);
  const Vec3d e = x.col(out.v[3]) - c, f = x.col(out.v[4]) - c;
  out.along = x.col(out.v[1]) - a;
  out.normal = e.cross(f);
  const double slope = out.normal.dot(out.along);
  out.t = slope == 0 ? 0.5 : std::clamp(out.normal.dot(c - a) / slope, 0.0, 1.0);
  out.p = a + out.t * out.along;
  const double area_sq = std::max(out.normal.squaredNorm(), 1e-300);
  const Vec3d q = out.p - c;
  const double s = q.cross(f).dot(out.normal) / area_sq, u = e.cross(q).dot(out.normal) / area_sq;
  out.part = Vec3d(1 - s - u, s, u);
  return out;
}

/// N . E, kept away from 0.
double slope_of(const Piercing& one) {
  const double slope = one.normal.dot(one.along), least = least_slope * one.normal.norm() * one.along.norm();
  return std::copysign(std::max(std::abs(slope), least), slope);
}

void add_gradient(const Piercing& one, const Vec3d& of_edge, const Vec3d& of_triangle, Positions& out) {
  out.col(one.v[0]) += (1 - one.t) * of_edge;
  out.col(one.v[1]) += one.t * of_edge;
  for (int k = 0; k < 3; ++k) out.col(one.v[static_cast<std::size_t>(k + 2)]) += one.part[k] * of_triangle;
}

/// The height of the nearer end of an edge over the triangle's plane, which is to become 0.
double add_height(const Piercing& one, const Positions& x, Positions& gradient) {
  const Vec3d n = one.normal.normalized();
  const double at_a = n.dot(x.col(one.v[0]) - one.p), at_b = n.dot(x.col(one.v[1]) - one.p);
  const bool nearer_a = std::abs(at_a) <= std::abs(at_b);
  const Vec3d up = (nearer_a ? at_a : at_b) < 0 ? Vec3d(-n) : n;
  gradient.col(one.v[nearer_a ? 0 : 1]) += up;
  for (int k = 0; k < 3; ++k) gradient.col(one.v[static_cast<std::size_t>(k + 2)]) -= one.part[k] * up;
  return std::min(std::abs(at_a), std::abs(at_b));
}

std::map<std::array<int, 2>, std::vector<int>> triangles_of_edges(const audit::AuditMesh& mesh) {
  std::map<std::array<int, 2>, std::vector<int>> out;
  for (int t = 0; t < static_cast<int>(mesh.triangles.cols()); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles(k, t), b = mesh.triangles((k + 1) % 3, t);
      out[{std::min(a, b), std::max(a, b)}].push_back(t);
    }
  }
  return out;
}

}  // namespace

ContourLength contour_length(const Tangle& tangle, const Positions& x) {
  const audit::AuditMesh& mesh = tangle.mesh;
  const auto triangles = triangles_of_edges(mesh);
  std::vector<Piercing> all;
  std::map<std::pair<int, int>, std::vector<std::size_t>> ends;
  ContourLength out{0, Positions::Zero(3, x.cols()), 0};
  for (const audit::PairName& pair : audit::all_crossings(mesh, x)) {
    if (pair.kind != audit::PairKind::edge_triangle) continue;
    ++out.crossings;
    all.push_back(piercing_of(vertices_of(mesh, pair), x));
    const int a = all.back().v[0], b = all.back().v[1];
    const auto found = triangles.find({std::min(a, b), std::max(a, b)});
    if (found == triangles.end()) continue;
    for (const int t : found->second) ends[std::minmax(t, pair.second)].push_back(all.size() - 1);
  }
  for (const auto& [pair, of] : ends) {
    if (of.size() != 2) continue;
    Piercing &p = all[of[0]], &q = all[of[1]];
    const Vec3d r = p.p - q.p;
    if (!(r.norm() > 0)) continue;
    out.length += r.norm();
    p.pull += r.normalized(), q.pull -= r.normalized();
    ++p.segments, ++q.segments;
  }
  for (const Piercing& one : all) {
    if (one.segments == 0) {
      out.length += add_height(one, x, out.gradient);
      continue;
    }
    const Vec3d across = one.normal * (one.pull.dot(one.along) / slope_of(one));
    add_gradient(one, one.pull - across, across, out.gradient);
  }
  return out;
}

std::optional<Positions> shorten_contours(const Tangle& tangle, int& iterations) {
  Positions x = tangle.start();
  const double mean_mass = [&] {
    double sum = 0, n = 0;
    for (const double w : tangle.inverse_mass) {
      if (w > 0) sum += 1 / w, ++n;
    }
    return sum / n;
  }();
  const double longest = 0.1 * tangle.mean_edge();
  for (int k = 0; k < tangle.options.most_iterations; ++k, ++iterations) {
    const ContourLength contour = contour_length(tangle, x);
    if (contour.crossings == 0) return x;
    Positions way = -contour.gradient;
    for (Eigen::Index v = 0; v < way.cols(); ++v)
      way.col(v) *= mean_mass * tangle.inverse_mass[static_cast<std::size_t>(v)];
    const double fall = -(way.cwiseProduct(contour.gradient)).sum(),
                 largest = way.colwise().norm().maxCoeff();
    if (!(fall > 0)) return std::nullopt;  // nothing that can move makes it shorter
    const double least = 0.01 * longest / largest;
    const double step = std::clamp(1.05 * contour.length / fall, least, longest / largest);
    std::vector<HalfSpace> lengths;
    tangle.add_lengths(x, lengths);
    x = nearest_point(x + step * way, lengths, tangle.inverse_mass, 1e-6 * longest, 20);
  }
  return std::nullopt;
}

}  // namespace bb
