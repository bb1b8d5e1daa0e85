#include "experiments/start/start_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/audit/state_audit.hpp"
#include "core/contact/pair_name.hpp"
#include "core/model/mesh/write_mesh.hpp"
#include "core/model/scene/contact_plan.hpp"
#include "experiments/run/audit_verdict.hpp"
#include "experiments/run/csv_cell.hpp"
#include "experiments/start/near_pairs.hpp"

namespace bb {
namespace {

constexpr double no_gap = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t most_body_pairs = 5, most_pairs = 3;  // that a terminal shows

bool is_obstacle(audit::PairKind kind) {
  return kind == audit::PairKind::vertex_obstacle || kind == audit::PairKind::edge_obstacle ||
         kind == audit::PairKind::triangle_obstacle;
}

ContactKey crossing_key(const audit::PairName& pair, const std::vector<int>& vertices) {
  const auto last = vertices.size() > 1 ? vertices.back() : vertices.front();
  if (is_obstacle(pair.kind)) return obstacle_key(pair.second, std::array{vertices.front()});
  return pair_key(std::array{vertices.front(), last});
}

Vec3d mean_of(const std::vector<int>& vertices, const Positions& x) {
  Vec3d sum = Vec3d::Zero();
  for (const int v : vertices) sum += x.col(v);
  return sum / static_cast<double>(vertices.size());
}

std::vector<StartPair> crossings_of(const Scene& scene, const audit::AuditMesh& mesh, const Positions& x) {
  std::vector<StartPair> out;
  for (const audit::PairName& pair : audit::all_crossings(mesh, x)) {
    StartPair one;
    one.vertices = vertices_of(mesh, pair);
    one.bodies = body_pair(scene, crossing_key(pair, one.vertices));
    one.text = describe(scene, mesh, pair);
    one.place = place_of(mesh, pair, x);
    one.gap = no_gap;
    out.push_back(std::move(one));
  }
  return out;
}

std::vector<StartPair> near_of(const RunConfig& config, const Scene& scene, const Positions& x) {
  std::vector<StartPair> out;
  for (const NearPair& near : NearPairs(config, scene).find(x)) {
    StartPair one;
    const ContactKey key = near.key();
    one.bodies = body_pair(scene, key);
    one.text = pair_name(scene, key, near.kind);
    one.place = near.place;
    one.gap = near.gap;
    one.within_thickness = !(near.gap > 0);
    for (const int v : near.vertex) {
      if (v >= 0) one.vertices.push_back(v);
    }
    out.push_back(std::move(one));
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.gap < b.gap; });
  return out;
}

std::string lines_of(const Scene& scene, const std::vector<StartPair>& pairs, const std::string& what) {
  if (pairs.empty()) return {};
  const auto counts = by_bodies(pairs);
  std::string out = fmt::format("  {} {}, in {} {} of bodies\n", pairs.size(), what, counts.size(),
                                counts.size() == 1 ? "pair" : "pairs");
  std::size_t shown = 0;
  for (const auto& [bodies, count] : counts) {
    if (shown++ == most_body_pairs) break;
    out += fmt::format("    {}: {}\n", name_of(scene, bodies), count);
    std::size_t first = 0;
    for (const StartPair& one : pairs) {
      if (one.bodies != bodies || first == most_pairs) continue;
      ++first;
      out += fmt::format("      {}, at ({:.4g}, {:.4g}, {:.4g}) m", one.text, one.place.x(), one.place.y(),
                         one.place.z());
      out += std::isnan(one.gap) ? "\n" : fmt::format(", gap {:.3g} m\n", one.gap);
    }
    if (const long more = count - static_cast<long>(first); more > 0)
      out += fmt::format("      and {} more\n", more);
  }
  if (counts.size() > most_body_pairs)
    out += fmt::format("    and {} more pairs of bodies\n", counts.size() - most_body_pairs);
  return out;
}

}  // namespace

bool StartReport::clean() const { return crossings.empty() && within_thickness() == 0; }

long StartReport::within_thickness() const {
  return std::count_if(near.begin(), near.end(), [](const StartPair& one) { return one.within_thickness; });
}

std::vector<int> vertices_of(const audit::AuditMesh& mesh, const audit::PairName& pair) {
  std::vector<int> out;
  const auto edge = [&](int e) { out.insert(out.end(), {mesh.edges(0, e), mesh.edges(1, e)}); };
  const auto triangle = [&](int t) {
    out.insert(out.end(), {mesh.triangles(0, t), mesh.triangles(1, t), mesh.triangles(2, t)});
  };
  switch (pair.kind) {
    case audit::PairKind::edge_triangle:
      edge(pair.first), triangle(pair.second);
      break;
    case audit::PairKind::edge_edge_2d:
    case audit::PairKind::edge_edge:
      edge(pair.first), edge(pair.second);
      break;
    case audit::PairKind::vertex_triangle:
      out.push_back(pair.first), triangle(pair.second);
      break;
    case audit::PairKind::vertex_edge_2d:
      out.push_back(pair.first), edge(pair.second);
      break;
    case audit::PairKind::vertex_obstacle:
      out.push_back(pair.first);
      break;
    case audit::PairKind::edge_obstacle:
      edge(pair.first);
      break;
    case audit::PairKind::triangle_obstacle:
    case audit::PairKind::inverted:
      triangle(pair.first);
      break;
  }
  return out;
}

Vec3d place_of(const audit::AuditMesh& mesh, const audit::PairName& pair, const Positions& x) {
  const std::vector<int> v = vertices_of(mesh, pair);
  if (pair.kind != audit::PairKind::edge_triangle) return mean_of(v, x);
  const Vec3d p = x.col(v[0]), along = x.col(v[1]) - p, a = x.col(v[2]);
  const Vec3d normal = (x.col(v[3]) - a).cross(x.col(v[4]) - a);
  const double slope = normal.dot(along);
  return slope == 0 ? mean_of(v, x) : Vec3d(p + along * (normal.dot(a - p) / slope));
}

std::map<BodyPair, long> by_bodies(const std::vector<StartPair>& pairs) {
  std::map<BodyPair, long> out;
  for (const StartPair& one : pairs) ++out[one.bodies];
  return out;
}

StartReport report_start(const RunConfig& config, const Scene& scene, const audit::AuditMesh& mesh,
                         const Positions& x) {
  return {crossings_of(scene, mesh, x), near_of(config, scene, x)};
}

std::string start_csv(const Scene& scene, const StartReport& report) {
  std::string out = "kind,bodies,pair,x_m,y_m,z_m,gap_m\n";
  const auto add = [&](const char* kind, const std::vector<StartPair>& pairs) {
    for (const StartPair& one : pairs) {
      out += fmt::format("{},{},{},{:.17g},{:.17g},{:.17g},", kind, csv_cell(name_of(scene, one.bodies)),
                         csv_cell(one.text), one.place.x(), one.place.y(), one.place.z());
      out += std::isnan(one.gap) ? "\n" : fmt::format("{:.17g}\n", one.gap);
    }
  };
  add("crossing", report.crossings);
  add("near", report.near);
  return out;
}

std::string marked_start(const Scene& scene, const StartReport& report) {
  TriangleMesh mesh;
  mesh.vertices = scene.x0.leftCols(scene.n_body_vertices());
  mesh.triangles = scene.surface_triangles;
  mesh.segments = lone_edges(scene);
  const auto n = static_cast<std::size_t>(mesh.n_vertices());
  const auto marks = [n](const std::vector<StartPair>& pairs) {
    std::vector<int> out(n, 0);
    for (const StartPair& one : pairs) {
      for (const int v : one.vertices) {
        if (static_cast<std::size_t>(v) < n) out[static_cast<std::size_t>(v)] = 1;
      }
    }
    return out;
  };
  const std::vector<int> crossing = marks(report.crossings);
  std::vector<int> of_triangles, body_of_triangles;
  for (const auto& t : mesh.triangles) {
    body_of_triangles.push_back(scene.body[static_cast<std::size_t>(t[0])]);
    of_triangles.push_back(
        std::all_of(t.begin(), t.end(), [&](int v) { return crossing[static_cast<std::size_t>(v)] != 0; }));
  }
  const std::vector<int> body(scene.body.begin(), scene.body.begin() + static_cast<long>(n));
  return ply_bytes(mesh, {{"body", body}, {"crossing", crossing}, {"near", marks(report.near)}},
                   {{"body", body_of_triangles}, {"crossing", of_triangles}});
}

std::string start_text(const Scene& scene, const StartReport& report) {
  std::string out = lines_of(scene, report.crossings, "crossings and places beyond obstacles");
  out += lines_of(scene, report.near, "pairs nearer than their d_hat");
  if (const long thick = report.within_thickness(); thick > 0)
    out += fmt::format("    of them {} with a gap that is not positive once thickness is taken off\n", thick);
  return out;
}

}  // namespace bb
