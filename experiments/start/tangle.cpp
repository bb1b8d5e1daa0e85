#include "experiments/start/tangle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/audit/state_audit.hpp"
#include "experiments/run/audit_mesh.hpp"
#include "experiments/start/start_report.hpp"

namespace bb {
namespace {

constexpr double never_moves = std::numeric_limits<double>::infinity();

int root_of(std::vector<int>& parent, int v) {
  while (parent[static_cast<std::size_t>(v)] != v) {
    int& up = parent[static_cast<std::size_t>(v)];
    up = parent[static_cast<std::size_t>(up)];
    v = up;
  }
  return v;
}

template <class Elements>
void join(const Elements& elements, std::vector<int>& parent) {
  for (const auto& element : elements) {
    for (const int v : element)
      parent[static_cast<std::size_t>(root_of(parent, v))] = root_of(parent, element[0]);
  }
}

template <class Elements>
void add_sides(const Elements& elements, std::vector<std::array<int, 2>>& out) {
  for (const auto& element : elements) {
    for (std::size_t i = 0; i < element.size(); ++i) {
      for (std::size_t k = i + 1; k < element.size(); ++k)
        out.push_back({std::min(element[i], element[k]), std::max(element[i], element[k])});
    }
  }
}

std::vector<double> inverse_masses(const Scene& scene) {
  std::vector<double> out(scene.mass.size(), 0);
  for (std::size_t v = 0; v < out.size(); ++v) out[v] = scene.mass[v] > 0 ? 1 / scene.mass[v] : 0;
  for (const Pin& pin : scene.pins) out[static_cast<std::size_t>(pin.vertex)] = 0;
  return out;
}

}  // namespace

Tangle::Tangle(const RunConfig& config, const Scene& of, const RepairOptions& how)
    : scene(of),
      options(how),
      mesh(audit_mesh_of(config, of)),
      inverse_mass(inverse_masses(of)),
      near_(config, of) {
  find_components();
  find_edges();
}

void Tangle::find_components() {
  std::vector<int> parent(static_cast<std::size_t>(scene.n_vertices()));
  std::iota(parent.begin(), parent.end(), 0);
  join(scene.surface_triangles, parent);
  join(scene.surface_edges, parent);
  for (const SolidPart& solid : scene.solids) join(solid.tetrahedra, parent);
  component.assign(parent.size(), -1);
  for (int v = 0; v < scene.n_vertices(); ++v) {
    int& of_root = component[static_cast<std::size_t>(root_of(parent, v))];
    if (of_root < 0) of_root = n_components++;
    component[static_cast<std::size_t>(v)] = of_root;
  }
  component_mass.assign(static_cast<std::size_t>(n_components), 0);
  for (std::size_t v = 0; v < parent.size(); ++v) {
    double& mass = component_mass[static_cast<std::size_t>(component[v])];
    mass += inverse_mass[v] > 0 ? 1 / inverse_mass[v] : never_moves;
  }
}

void Tangle::find_edges() {
  add_sides(scene.surface_triangles, edges_);
  add_sides(scene.surface_edges, edges_);
  for (const SolidPart& solid : scene.solids) add_sides(solid.tetrahedra, edges_);
  std::sort(edges_.begin(), edges_.end());
  edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
  for (const auto& [a, b] : edges_) length_.push_back((start().col(a) - start().col(b)).norm());
  const double sum = std::accumulate(length_.begin(), length_.end(), 0.0);
  mean_edge_ = length_.empty() ? widest_gap() : sum / static_cast<double>(length_.size());
}

bool Tangle::movable(int c) const {
  return c >= 0 && component_mass[static_cast<std::size_t>(c)] < never_moves;
}

std::array<int, 2> Tangle::components_of(const audit::PairName& pair) const {
  const std::vector<int> vertices = vertices_of(mesh, pair);
  const auto of = [this](int v) { return component[static_cast<std::size_t>(v)]; };
  const bool two = pair.kind == audit::PairKind::edge_triangle;
  return {of(vertices.front()), two ? of(vertices.back()) : -1};
}

bool Tangle::clean(const Positions& x) const {
  const audit::StateAudit found = audit::audit_state(mesh, x, true);
  return found.finite && found.crossings + found.obstacle_violations + found.scene_faults == 0;
}

bool Tangle::apart(const Positions& x) {
  const std::vector<NearPair> pairs = near_.find(x);
  return std::all_of(pairs.begin(), pairs.end(), [](const NearPair& near) { return near.gap > 0; });
}

double Tangle::slack(const Positions& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const NearPair& near : near_.find(x))
    least = std::min(least, near.gap - options.gap_fraction * near.d_hat);
  return least;
}

double Tangle::strain(const Positions& x) const {
  double most = 0;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (!(length_[i] > 0)) continue;
    const double now = (x.col(edges_[i][0]) - x.col(edges_[i][1])).norm();
    most = std::max(most, std::abs(now / length_[i] - 1));
  }
  return most;
}

void Tangle::add_lengths(const Positions& x, std::vector<HalfSpace>& out) const {
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const auto [a, b] = edges_[i];
    const Vec3d along = x.col(a) - x.col(b);
    const double now = along.norm();
    if (!(now > 0)) continue;
    const Vec3d normal = along / now;
    out.push_back({{a, b, -1, -1}, {1, -1, 0, 0}, normal, length_[i] * (1 - options.stretch)});
    out.push_back({{a, b, -1, -1}, {-1, 1, 0, 0}, normal, -length_[i] * (1 + options.stretch)});
  }
}

std::vector<HalfSpace> Tangle::sides(const Positions& x, const Positions& x1) {
  const double way = (x1 - x).colwise().norm().maxCoeff();
  std::vector<HalfSpace> out;
  for (const NearPair& near : near_.find(x, x1, 2 * way)) {
    if (near.normal.isZero(0)) continue;
    HalfSpace side{near.vertex, near.weight, near.normal, options.gap_fraction * near.d_hat - near.gap};
    for (std::size_t k = 0; k < 4 && near.vertex[k] >= 0; ++k)
      side.bound += near.weight[k] * near.normal.dot(x.col(near.vertex[k]));
    out.push_back(side);
  }
  add_lengths(x, out);
  return out;
}

double Tangle::cost(const Positions& x) const {
  double sum = 0;
  for (std::size_t v = 0; v < inverse_mass.size(); ++v) {
    const auto i = static_cast<Eigen::Index>(v);
    if (inverse_mass[v] > 0) sum += (x.col(i) - start().col(i)).squaredNorm() / inverse_mass[v];
  }
  return sum;
}

double Tangle::widest_gap() const {
  const double d_hat = *std::max_element(scene.d_hat.begin(), scene.d_hat.end());
  return options.gap_fraction * d_hat + 2 * *std::max_element(scene.offset.begin(), scene.offset.end());
}

}  // namespace bb
