// Drag of the air on an executor: every corner sums up its triangles at the start of a step.
#include "core/terms/air_drag.hpp"

#include "core/energy/families/element_columns.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/vertex_quadratic.hpp"

namespace bb::resident {
namespace {

class AirDragTerm final : public QuadraticTerm {
 public:
  explicit AirDragTerm(const ResidentInputs& inputs)
      : QuadraticTerm(inputs, "air_drag", corners_in_air(inputs.scene)),
        scene_(inputs.scene),
        triangle_(executor_, "triangles in the air"),
        start_(executor_, "triangles of corners in the air, starts"),
        of_(executor_, "triangles of corners in the air"),
        coefficient_(executor_, "air_drag coefficients", 9 * size()) {
    triangle_.upload(flat(scene_.surface_triangles));
    upload_lists();
  }

  void begin_step(const ResidentFrame& frame) override {
    executor_.each(size(),
                   DragCoefficients{triangle_.data(), start_.data(), of_.data(), size(), scene_.air.normal,
                                    scene_.air.tangential, frame.x_n->data(), coefficient_.data()});
    change_frame(frame);
  }
  void change_frame(const ResidentFrame& frame) override {
    const Vec3d wind = wind_at(scene_.air, frame.t_end);
    executor_.each(
        size(),
        DragInWind{elements_, coefficient_.data(), frame.x_n->data(), {wind[0], wind[1], wind[2]}, frame.dt});
  }

 private:
  void upload_lists() {
    std::vector<std::vector<std::uint32_t>> of_vertex(scene_.mass.size());
    for (std::size_t t = 0; t < scene_.surface_triangles.size(); ++t) {
      for (const int v : scene_.surface_triangles[t]) {
        of_vertex[static_cast<std::size_t>(v)].push_back(static_cast<std::uint32_t>(t));
      }
    }
    std::vector<std::uint32_t> start = {0}, of;
    for (const int v : corners_in_air(scene_)) {
      const auto& own = of_vertex[static_cast<std::size_t>(v)];
      of.insert(of.end(), own.begin(), own.end());
      start.push_back(static_cast<std::uint32_t>(of.size()));
    }
    start_.upload(start);
    of_.upload(of);
  }

  const Scene& scene_;
  Buffer<int> triangle_;  // [3 triangles]
  Buffer<std::uint32_t> start_, of_;
  Buffer<double> coefficient_;  // [9, n] N s/m
};

}  // namespace

void make_resident_air_drag(const ResidentInputs& inputs, ResidentTermList& terms) {
  terms.add(std::make_unique<AirDragTerm>(inputs));
}

}  // namespace bb::resident
