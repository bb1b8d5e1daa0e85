// Drag of the air on triangles: every corner of a triangle of area A bears -A/3 (c_n u_n + c_t u_t), u_n and u_t the parts of its
// velocity relative to the wind along and across the triangle's normal. Areas and normals are those of the start of the step,
// the velocity is (x - x_n)/h: the term is 1/(2 h) u^T C u with u = x - x_n - h wind, and convex.
#include "core/terms/air_drag.hpp"

#include "core/energy/air_drag.hpp"
#include "core/terms/registry.hpp"
#include "core/terms/vertex_quadratic.hpp"

namespace bb {

std::vector<int> corners_in_air(const Scene& scene) {
  std::vector<std::uint8_t> met(scene.mass.size(), 0);
  for (const auto& t : scene.surface_triangles) {
    for (const int v : t) met[static_cast<std::size_t>(v)] = 1;
  }
  std::vector<int> out;
  for (std::size_t v = 0; v < met.size(); ++v) {
    if (met[v] != 0 && scene.mass[v] > 0) out.push_back(static_cast<int>(v));
  }
  return out;
}

Vec3d wind_at(const Air& air, double t) {
  return air.wind_keys.empty() ? air.wind : value_at(air.wind_keys, t);
}

namespace {

class AirDrag final : public VertexQuadratic {
 public:
  explicit AirDrag(const Scene& scene)
      : VertexQuadratic(corners_in_air(scene)),
        scene_(scene),
        element_(scene.mass.size(), -1),
        coefficient_(n_elements()) {
    for (std::size_t e = 0; e < n_elements(); ++e) {
      element_[static_cast<std::size_t>(vertex(e))] = static_cast<int>(e);
    }
  }
  std::string_view name() const override { return "air_drag"; }

  void begin_step(const StepFrame& frame, PhaseClock&) override {
    x_n_ = frame.x_n;
    for (Mat3d& c : coefficient_) c.setZero();
    for (const auto& t : scene_.surface_triangles) add_triangle(t);
    change_frame(frame);
  }
  void change_frame(const StepFrame& frame) override {
    const Vec3d wind = wind_at(scene_.air, frame.t_end);
    for (std::size_t e = 0; e < n_elements(); ++e) {
      set(e, x_n_.col(vertex(e)) + frame.dt * wind, coefficient_[e] / frame.dt);
    }
  }

 private:
  void add_triangle(const std::array<int, 3>& t) {
    const Vec3d x[3] = {x_n_.col(t[0]), x_n_.col(t[1]), x_n_.col(t[2])};
    const Mat3d part = drag_of_corner<double>(x, scene_.air.normal, scene_.air.tangential);
    for (const int v : t) {
      const int e = element_[static_cast<std::size_t>(v)];
      if (e >= 0) coefficient_[static_cast<std::size_t>(e)] += part;
    }
  }

  const Scene& scene_;
  std::vector<int> element_;        // [n_vertices] -1: none
  std::vector<Mat3d> coefficient_;  // [n] N s/m
  Positions x_n_;
};

}  // namespace

PlanItem needs_air_drag(const TermNeeds& needs) {
  const Air& air = needs.scene.air;
  const bool some = (air.normal > 0 || air.tangential > 0) && !needs.scene.surface_triangles.empty();
  return plan_item(some, "the air has drag", "no drag of the air, or no triangle in it");
}

void make_air_drag(const TermInputs& inputs, TermList& terms) {
  terms.add(std::make_unique<AirDrag>(inputs.scene));
}

}  // namespace bb
