// A pressure from within closed surfaces: the columns of its triangles, and the bodies whose centres they are seen from.
#include "core/energy/families/inflation.hpp"

#include "core/energy/families/families.hpp"
#include "core/energy/families/family_of.hpp"

namespace bb {
namespace {

class InflationFamily final : public FamilyOf<Inflated> {
 public:
  InflationFamily(const FamilyPlace& place, const Scene& scene)
      : FamilyOf(place, "inflated vertices", std::span(scene.inflation.triangles)),
        key_lists_(scene.inflation.key_lists),
        key_(place.executor, "keys of pressures"),
        body_(place.executor, "inflated bodies"),
        pressure_(place.executor, "pressures"),
        factor_(place.executor, "factors of pressures"),
        range_(place.executor, "vertices of inflated bodies"),
        centre_(place.executor, "centres of inflated bodies") {
    pressure_.upload(scene.inflation.pressure);
    std::vector<int> key = scene.inflation.keys;
    key.resize(scene.inflation.triangles.size(), -1);
    key_.upload(key);
    upload_bodies(scene);
    elements_.pressure = pressure_.data();
    elements_.key = key_.data();
    elements_.body = body_.data();
    elements_.centre = centre_.data();
  }

  void begin_step(const FamilyStep& step) override {
    place_.executor.blocks(range_.size(), BodyCentres{range_.data(), step.x_n, centre_.data()});
    change_step(step);
  }
  void change_step(const FamilyStep& step) override {
    std::vector<double> now;
    for (const auto& keys : key_lists_) now.push_back(value_at(keys, step.t_end));
    factor_.upload(now);
    elements_.factor = factor_.data();
  }

 private:
  /// Numbered anew: those with a pressure alone.
  void upload_bodies(const Scene& scene) {
    std::vector<int> number(scene.bodies.size(), -1), body;
    std::vector<VertexRange> range;
    for (const auto& triangle : scene.inflation.triangles) {
      const auto b = static_cast<std::size_t>(scene.body[static_cast<std::size_t>(triangle[0])]);
      if (number[b] < 0) {
        number[b] = static_cast<int>(range.size());
        range.push_back({scene.bodies[b].first_vertex, scene.bodies[b].n_vertices});
      }
      body.push_back(number[b]);
    }
    body_.upload(body);
    range_.upload(range);
    centre_.resize(3 * range_.size());
  }

  const std::vector<std::vector<PressureKey>>& key_lists_;
  exec::Buffer<int> key_, body_;
  exec::Buffer<double> pressure_, factor_;
  exec::Buffer<VertexRange> range_;
  exec::Buffer<double> centre_;
};

}  // namespace

MadeFamily inflation_family(const FamilyPlace& place, const Scene& scene) {
  return std::make_unique<InflationFamily>(place, scene);
}

}  // namespace bb
