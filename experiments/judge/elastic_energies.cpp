#include "experiments/judge/elastic_energies.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "core/energy/families/element_family.hpp"
#include "core/energy/local_terms.hpp"
#include "core/exec/host_executor.hpp"
#include "core/math/error.hpp"
#include "core/model/bodies/part.hpp"
#include "experiments/config/parse.hpp"

namespace bb::judge {
struct ElasticEnergies::Elements {
  struct NamedFamily {
    std::string_view part;
    std::unique_ptr<ElementFamily> family;
  };

  exec::HostExecutor executor;
  Scene scene;
  std::vector<NamedFamily> families;
  std::vector<int> vertices;  // of the subject
  std::vector<int> given;     // those of the scene that it moves
  Positions now, last, load, last_load;

  void take(const Positions& x) {
    now.resize(3, static_cast<Eigen::Index>(vertices.size()));
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      now.col(static_cast<Eigen::Index>(k)) = x.col(vertices[k]);
    }
  }
  /// Adds up the gradients of all elements, N.
  void add_loads() {
    load.setZero(3, now.cols());
    LocalTerms terms;
    for (const NamedFamily& one : families) {
      one.family->derivatives(now.data(), Projection::none, terms);
      const std::span<const int> corners = one.family->vertices();
      for (std::size_t c = 0; c < corners.size(); ++c) {
        load.col(corners[c]) += Eigen::Map<const Vec3d>(terms.grad.data() + 3 * c);
      }
    }
  }
};

ElasticEnergies::~ElasticEnergies() = default;

ElasticEnergies::ElasticEnergies(const ElasticPart& part, const std::vector<std::uint8_t>& given)
    : elements_(std::make_unique<Elements>()) {
  Elements& e = *elements_;
  e.scene = build_scene(load_config(part.config));
  e.vertices = part.vertices;
  if (static_cast<std::size_t>(e.scene.n_vertices()) != e.vertices.size()) {
    throw ConfigError(part.config, fmt::format("{} vertices", e.scene.n_vertices()),
                      fmt::format("{}, as in the list", e.vertices.size()));
  }
  for (const PartEntry& entry : part_entries()) {
    std::vector<std::unique_ptr<ElementFamily>> made;
    entry.part.add_families(e.scene, {e.executor}, made);
    for (auto& family : made) e.families.push_back({entry.name, std::move(family)});
  }
  for (std::size_t k = 0; k < e.vertices.size(); ++k) {
    if (!given.empty() && given[static_cast<std::size_t>(e.vertices[k])] != 0) {
      e.given.push_back(static_cast<int>(k));
    }
  }
}

nlohmann::ordered_json ElasticEnergies::energies(const Positions& x) {
  Elements& e = *elements_;
  e.take(x);
  nlohmann::ordered_json out = nlohmann::ordered_json::object();
  for (const Elements::NamedFamily& one : e.families) {
    std::vector<double> of(static_cast<std::size_t>(one.family->size()));
    one.family->values(e.now.data(), of.data());
    const std::string name(one.part);
    out[name] = out.value(name, 0.0) + std::accumulate(of.begin(), of.end(), 0.0);
  }
  return out;
}

double ElasticEnergies::work_of_given(const Positions& x) {
  Elements& e = *elements_;
  if (e.given.empty()) return 0;
  e.take(x);
  e.add_loads();
  double work = 0;
  if (e.last.cols() > 0) {
    for (const int k : e.given) {
      work += 0.5 * (e.load.col(k) + e.last_load.col(k)).dot(e.now.col(k) - e.last.col(k));
    }
  }
  e.last = e.now, e.last_load = e.load;
  return work;
}

}  // namespace bb::judge
