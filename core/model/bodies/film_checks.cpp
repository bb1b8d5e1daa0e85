#include "core/model/bodies/film_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "core/model/mesh/bounds.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

constexpr double same_place = 1e-6;  // of size and distance from the origin: what numbers of 24 bits keep

double diagonal(const Positions& x) {
  return x.cols() == 0 ? 0 : (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
}

Positions frame_at(const Film& film, double t) {
  Positions out(3, film.n_vertices());
  film.at(t, out);
  return out;
}

/// Whether its numbers are those of such a body at all.
bool check_numbers(const Complaints& report, const std::string& what, const Film& film, int n_vertices,
                   bool planar) {
  if (film.n_vertices() != n_vertices) {
    report(what, fmt::format("{} vertices in every frame", film.n_vertices()),
           fmt::format("{}, as the mesh of the body has", n_vertices));
    return false;
  }
  for (const double t : film.times()) {
    const Positions x = frame_at(film, t);
    if (!within_bounds(x)) {
      report(what, fmt::format("a coordinate that is NaN or too large at {:g} s", t), allowed_coordinates());
      return false;
    }
    if (!planar || x.row(2).isZero(0)) continue;
    report(what, fmt::format("a vertex with z != 0 at {:g} s", t), "z = 0: the scene is planar");
    return false;
  }
  return true;
}

/// Two shapes of very different size are probably in different units.
std::string unit_hint(const Positions& film, const Positions& start) {
  const double ratio = diagonal(film) / diagonal(start);
  if (ratio > 0.2 && ratio < 5) return "";
  return fmt::format("; the film is {:.4g} times as large as the body, so its unit may be another", ratio);
}

}  // namespace

void check_film(const Complaints& report, const std::string& what, const PrescribedMotion& motion,
                const BodySpec& spec, bool planar) {
  if (motion.film) check_numbers(report, what + "/film", *motion.film, spec.mesh.n_vertices(), planar);
}

void check_film_start(const Complaints& report, const std::string& what, const PrescribedMotion& motion,
                      const Positions& start, std::span<const int> vertices) {
  if (!motion.film || motion.film->n_vertices() != start.cols()) return;
  const Positions x = frame_at(*motion.film, 0);
  const double allowed = same_place * (diagonal(start) + start.cwiseAbs().maxCoeff());
  for (const int v : vertices) {
    const double apart = (x.col(v) - start.col(v)).norm();
    if (apart <= allowed) continue;
    return report(what + "/film",
                  fmt::format("vertex {} {:.4g} m from where the body starts, at the time 0{}", v, apart,
                              unit_hint(x, start)),
                  "a film that begins where the body starts: vertices that are prescribed do not jump");
  }
}

void check_rest_film(const Complaints& report, const BodySpec& spec, bool planar) {
  for (const ShrinkKey& key : spec.material.shrink_keys) {
    const auto& limit = spec.material.limit;
    if (!limit || key.value < 1 + limit->onset + limit->width) continue;
    report("/material/shrink_schedule", fmt::format("{}", key.value),
           fmt::format("factors < {}, the strain limit of the body, which is that of its mesh",
                       1 + limit->onset + limit->width));
  }
  if (!spec.rest_film) return;
  const Film& film = *spec.rest_film;
  if (!check_numbers(report, "/rest_film", film, spec.mesh.n_vertices(), planar)) return;
  if (spec.material.limit) {
    report("/rest_film", "a strain limit of a body whose rest shape moves",
           "limited false, since a rest shape that moves would carry elements over their limit between two "
           "steps");
  }
  for (const double t : film.times()) {
    const Positions x = frame_at(film, t);
    const auto flat = [&x](const auto& triangle) { return !(area_vector(x, triangle).norm() > 0); };
    const auto turned = [&x](const auto& solid) { return !(tetrahedron_volume(x, solid) > 0); };
    const auto& [triangles, solids] = std::tie(spec.mesh.triangles, spec.mesh.tetrahedra);
    const auto triangle = std::find_if(triangles.begin(), triangles.end(), flat);
    const auto solid = std::find_if(solids.begin(), solids.end(), turned);
    if (triangle != triangles.end()) {
      return report("/rest_film",
                    fmt::format("triangle {} without area at {:g} s", triangle - triangles.begin(), t),
                    "triangles of positive area in every frame");
    }
    if (solid != solids.end()) {
      return report("/rest_film",
                    fmt::format("tetrahedron {} of {:g} m^3 at {:g} s", solid - solids.begin(),
                                tetrahedron_volume(x, *solid), t),
                    "tetrahedra of positive volume in every frame");
    }
  }
}

}  // namespace bb
