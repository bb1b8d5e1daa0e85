// A pressure from within closed surfaces: the columns of its triangles, and the bodies whose centres they are seen from.
#include "core/energy/families/inflation.hpp"

#include <algorithm>

#include "core/energy/families/families.hpp"
#include "core/energy/families/family_of.hpp"

namespace bb {
namespace {

class InflationFamily final : public FamilyOf<Inflated> {
 public:
  InflationFamily(const FamilyPlace& place, const Scene& scene)
      : FamilyOf(place, "inflated vertices", std::span(scene.inflation.triangles)),
        inflation_(scene.inflation),
        key_(place.executor, "keys of pressures"),
        body_(place.executor, "inflated bodies"),
        pressure_(place.executor, "pressures"),
        factor_(place.executor, "factors of pressures"),
        range_(place.executor, "vertices of inflated bodies"),
        centre_(place.executor, "centres of inflated bodies"),
        beyond_(place.executor, "pressures beyond those of volumes"),
        area_(place.executor, "areas under pressure"),
        beyond_volume_(!scene.inflation.parts.empty() || !scene.inflation.weights.empty()) {
    pressure_.upload(inflation_.pressure);
    keys_ = inflation_.keys;
    keys_.resize(inflation_.triangles.size(), -1);
    key_.upload(beyond_volume_ ? std::vector<int>(keys_.size(), -1) : keys_);
    upload_bodies(scene);
    elements_.pressure = pressure_.data();
    elements_.key = key_.data();
    elements_.body = body_.data();
    elements_.centre = centre_.data();
    if (!beyond_volume_) return;
    area_.resize(3 * size());
    elements_.area = area_.data();
  }

  void begin_step(const FamilyStep& step) override {
    place_.executor.blocks(range_.size(), BodyCentres{range_.data(), step.x_n, centre_.data()});
    if (beyond_volume_) place_.executor.each(size(), AreaVectors{elements_, step.x_n, area_.data()});
    change_step(step);
  }
  void change_step(const FamilyStep& step) override {
    std::vector<double> now;
    for (const auto& keys : inflation_.key_lists) now.push_back(value_at(keys, step.t_end));
    if (beyond_volume_) return split(now, step.t_end);
    factor_.upload(now);
    elements_.factor = factor_.data();
  }

 private:
  /// Volumes have the mean pressure of their body, corners what theirs is beyond it.
  void split(const std::vector<double>& factors, double t) {
    const std::size_t n = inflation_.triangles.size();
    std::vector<double> pressure = inflation_.pressure, weight(n, 1.0), mean(n, 1.0), beyond(3 * n);
    for (const PressureWeights& of : inflation_.weights) mix(of, t, weight, mean);
    for (std::size_t e = 0; e < n; ++e) {
      if (keys_[e] >= 0) pressure[e] *= factors[static_cast<std::size_t>(keys_[e])];
      for (std::size_t k = 0; k < 3; ++k) {
        const double part = inflation_.parts.empty() ? 1.0 / 3 : inflation_.parts[e][k];
        beyond[k * n + e] = pressure[e] * (weight[e] * part - mean[e] / 3);
      }
      pressure[e] *= mean[e];
    }
    pressure_.upload(pressure);
    beyond_.upload(beyond);
    elements_.beyond = beyond_.data();
  }
  void mix(const PressureWeights& of, double t, std::vector<double>& weight,
           std::vector<double>& mean) const {
    const std::vector<double> of_vertices = of.mix.at(t);
    const auto first = static_cast<std::size_t>(of.first_triangle),
               n = static_cast<std::size_t>(of.n_triangles);
    double sum = 0;
    for (std::size_t e = first; e < first + n; ++e) {
      weight[e] = mean_weight(of_vertices, inflation_.triangles[e], of.first_vertex);
      sum += weight[e];
    }
    std::fill_n(mean.begin() + of.first_triangle, n, sum / of.n_triangles);
  }
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

  const Inflation& inflation_;
  std::vector<int> keys_;  // [n] into key_lists, -1: constant
  exec::Buffer<int> key_, body_;
  exec::Buffer<double> pressure_, factor_;
  exec::Buffer<VertexRange> range_;
  exec::Buffer<double> centre_;
  exec::Buffer<double> beyond_, area_;  // [3, n] each; empty: volumes say all
  const bool beyond_volume_;
};

}  // namespace

MadeFamily inflation_family(const FamilyPlace& place, const Scene& scene) {
  return std::make_unique<InflationFamily>(place, scene);
}

}  // namespace bb
