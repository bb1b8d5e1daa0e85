// A pressure from within closed surfaces, on an executor.
#include "core/energy/families/element_columns.hpp"
#include "core/resident/elements/element_term.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/inflation_kernels.hpp"

namespace bb::resident {
namespace {

class InflationTerm final : public TermOf<Inflated> {
 public:
  explicit InflationTerm(const ResidentInputs& inputs)
      : TermOf(inputs, "inflation", flat(inputs.scene.inflation.triangles), TermGroup::load, Phase::assembly),
        scene_(inputs.scene),
        vertex_(executor_, "inflated vertices"),
        key_(executor_, "keys of pressures"),
        body_(executor_, "inflated bodies"),
        pressure_(executor_, "pressures"),
        factor_(executor_, "factors of pressures"),
        range_(executor_, "vertices of inflated bodies"),
        centre_(executor_, "centres of inflated bodies") {
    const Inflation& of = scene_.inflation;
    vertex_.upload(to_columns<int>(flat(of.triangles), 3));
    pressure_.upload(of.pressure);
    std::vector<int> key = of.keys;
    key.resize(of.triangles.size(), -1);
    key_.upload(key);
    upload_bodies();
    elements_.of = vertex_.data();
    elements_.n = size();
    elements_.pressure = pressure_.data();
    elements_.key = key_.data();
    elements_.body = body_.data();
    elements_.centre = centre_.data();
  }

  void begin_step(const ResidentFrame& frame) override {
    executor_.blocks(range_.size(), BodyCentres{range_.data(), frame.x_n->data(), centre_.data()});
    change_frame(frame);
  }
  void change_frame(const ResidentFrame& frame) override {
    std::vector<double> now;
    for (const auto& keys : scene_.inflation.key_lists) now.push_back(value_at(keys, frame.t_end));
    factor_.upload(now);
    elements_.factor = factor_.data();
  }

 private:
  /// Numbered anew: those with a pressure alone.
  void upload_bodies() {
    std::vector<int> number(scene_.bodies.size(), -1), body;
    std::vector<VertexRange> range;
    for (const auto& triangle : scene_.inflation.triangles) {
      const auto b = static_cast<std::size_t>(scene_.body[static_cast<std::size_t>(triangle[0])]);
      if (number[b] < 0) {
        number[b] = static_cast<int>(range.size());
        range.push_back({scene_.bodies[b].first_vertex, scene_.bodies[b].n_vertices});
      }
      body.push_back(number[b]);
    }
    body_.upload(body);
    range_.upload(range);
    centre_.resize(3 * range_.size());
  }

  const Scene& scene_;
  Buffer<int> vertex_, key_, body_;
  Buffer<double> pressure_, factor_;
  Buffer<VertexRange> range_;
  Buffer<double> centre_;
};

}  // namespace

void make_resident_inflation(const ResidentInputs& inputs, ResidentTermList& terms) {
  terms.add(std::make_unique<InflationTerm>(inputs));
}

}  // namespace bb::resident
