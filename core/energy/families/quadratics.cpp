// Soft pins, k/2 |x - p(t)|^2 with p where the motion of a pin takes its vertex by the end of the step and k its stiffness then; and
// drag of the air, for which every corner sums up its triangles at the start of a step.
#include "core/energy/families/quadratics.hpp"

#include "core/energy/families/families.hpp"
#include "core/energy/families/family_of.hpp"

namespace bb {
namespace {

class QuadraticFamily : public FamilyOf<Quadratics> {
 protected:
  QuadraticFamily(const FamilyPlace& place, const Scene& scene, const std::string& name,
                  std::vector<int> vertices)
      : FamilyOf(place, name + " vertices", std::move(vertices)),
        scene_(scene),
        places_(place.executor, name + " places", 3 * size()),
        matrix_(place.executor, name + " matrices", 9 * size()) {
    elements_.place = places_.data(), elements_.matrix = matrix_.data();
  }

  const Scene& scene_;
  exec::Buffer<double> places_, matrix_;
};

/// Pull by pull.
std::vector<int> pulled_vertices(const Scene& scene) {
  std::vector<int> out;
  for (const Pull& pull : scene.pulls) out.insert(out.end(), pull.vertices.begin(), pull.vertices.end());
  return out;
}

/// N/m, in a step.
double stiffness_of(const Pull& pull, const FamilyStep& step) {
  if (!pull.span.holds(step.middle())) return 0;
  return pull.stiffness * (pull.factors.empty() ? 1 : value_at(pull.factors, step.t_end));
}

/// Places and stiffnesses of a step come from the host, as those of pins do.
class PullFamily final : public QuadraticFamily {
 public:
  PullFamily(const FamilyPlace& place, const Scene& scene)
      : QuadraticFamily(place, scene, "pull", pulled_vertices(scene)),
        at_(3 * static_cast<std::size_t>(size())),
        stiffness_(9 * static_cast<std::size_t>(size())) {}

  void change_step(const FamilyStep& step) override {
    const auto n = static_cast<std::size_t>(size());
    std::size_t e = 0;
    for (const Pull& pull : scene_.pulls) {
      const PrescribedMotion& motion = scene_.motions[static_cast<std::size_t>(pull.motion)];
      const double stiffness = stiffness_of(pull, step);
      const std::vector<double> weights =
          pull.weights.given() ? pull.weights.at(step.t_end) : std::vector<double>(pull.vertices.size(), 1.0);
      auto weight = weights.begin();
      for (const int v : pull.vertices) {
        const Vec3d to = motion.pose(v, scene_.x0.col(v), step.t_end);
        for (std::size_t c = 0; c < 3; ++c) {
          at_[c * n + e] = to[static_cast<Eigen::Index>(c)];
          stiffness_[4 * c * n + e] = stiffness * *weight;
        }
        ++e, ++weight;
      }
    }
    places_.upload(at_);
    matrix_.upload(stiffness_);
  }

 private:
  std::vector<double> at_, stiffness_;  // of places_ and matrix_, on the host
};

/// Corners with mass of the triangles of the surface, ascending, and the triangles of each.
struct CornersInAir {
  std::vector<int> vertices;
  std::vector<std::uint32_t> start = {0}, of;  // [n + 1]; ascending
  std::vector<double> thrice;                  // of each, three times what the corner bears; empty: 1
};
CornersInAir corners_in_air(const Scene& scene) {
  std::vector<std::vector<std::uint32_t>> of_vertex(scene.mass.size());
  for (std::size_t t = 0; t < scene.surface_triangles.size(); ++t) {
    for (const int v : scene.surface_triangles[t]) {
      of_vertex[static_cast<std::size_t>(v)].push_back(static_cast<std::uint32_t>(t));
    }
  }
  CornersInAir out;
  for (std::size_t v = 0; v < of_vertex.size(); ++v) {
    const std::vector<std::uint32_t>& own = of_vertex[v];
    if (own.empty() || !(scene.mass[v] > 0)) continue;
    out.vertices.push_back(static_cast<int>(v));
    out.of.insert(out.of.end(), own.begin(), own.end());
    out.start.push_back(static_cast<std::uint32_t>(out.of.size()));
    for (const std::uint32_t t : own) {
      if (scene.corner_parts.empty()) break;
      const auto& corner = scene.surface_triangles[t];
      const auto k = static_cast<std::size_t>(corner[0] == static_cast<int>(v)   ? 0
                                              : corner[1] == static_cast<int>(v) ? 1
                                                                                 : 2);
      out.thrice.push_back(3 * scene.corner_parts[t][k]);
    }
  }
  return out;
}

class AirDragFamily final : public QuadraticFamily {
 public:
  AirDragFamily(const FamilyPlace& place, const Scene& scene, CornersInAir corners)
      : QuadraticFamily(place, scene, "air_drag", std::move(corners.vertices)),
        triangle_(place.executor, "triangles in the air"),
        start_(place.executor, "triangles of corners in the air, starts"),
        of_(place.executor, "triangles of corners in the air"),
        thrice_(place.executor, "parts of triangles in the air"),
        coefficient_(place.executor, "air_drag coefficients", 9 * size()) {
    triangle_.upload(flat(scene.surface_triangles));
    start_.upload(corners.start);
    of_.upload(corners.of);
    thrice_.upload(corners.thrice);
  }

  void begin_step(const FamilyStep& step) override {
    place_.executor.each(
        size(), DragCoefficients{triangle_.data(), start_.data(), of_.data(),
                                 thrice_.size() > 0 ? thrice_.data() : nullptr, size(), scene_.air.normal,
                                 scene_.air.tangential, step.x_n, coefficient_.data()});
    change_step(step);
  }
  void change_step(const FamilyStep& step) override {
    const Air& air = scene_.air;
    const Vec3d wind = air.wind_keys.empty() ? air.wind : value_at(air.wind_keys, step.t_end);
    place_.executor.each(
        size(), DragInWind{elements_, coefficient_.data(), step.x_n, {wind[0], wind[1], wind[2]}, step.dt});
  }

 private:
  exec::Buffer<int> triangle_;  // [3 triangles]
  exec::Buffer<std::uint32_t> start_, of_;
  exec::Buffer<double> thrice_;
  exec::Buffer<double> coefficient_;  // [9, n] N s/m
};

}  // namespace

MadeFamily pull_family(const FamilyPlace& place, const Scene& scene) {
  return std::make_unique<PullFamily>(place, scene);
}
MadeFamily air_drag_family(const FamilyPlace& place, const Scene& scene) {
  return std::make_unique<AirDragFamily>(place, scene, corners_in_air(scene));
}

}  // namespace bb
