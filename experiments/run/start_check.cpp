#include "experiments/run/start_check.hpp"

#include <fmt/format.h>

#include <array>
#include <span>

#include "core/audit/audit.hpp"
#include "experiments/run/audit_mesh.hpp"

namespace bb {
namespace {

std::string name_of(const Scene& scene, std::span<const int> vertices) {
  const Body& body =
      scene.bodies[static_cast<std::size_t>(scene.body[static_cast<std::size_t>(vertices.front())])];
  std::string text = body.name + "[";
  for (const int v : vertices) {
    if (text.back() != '[') text += ' ';
    text += std::to_string(v - body.first_vertex);
  }
  return text + "]";
}

std::string describe(const Scene& scene, const audit::AuditMesh& mesh, const audit::PairName& pair) {
  const auto edge = [&](int i) {
    return "edge " + name_of(scene, std::array{mesh.edges(0, i), mesh.edges(1, i)});
  };
  const auto triangle = [&](int i) {
    return "triangle " +
           name_of(scene, std::array{mesh.triangles(0, i), mesh.triangles(1, i), mesh.triangles(2, i)});
  };
  const auto vertex = [&](int v) { return "vertex " + name_of(scene, std::array{v}); };
  switch (pair.kind) {
    case audit::PairKind::edge_triangle:
      return edge(pair.first) + " crosses " + triangle(pair.second);
    case audit::PairKind::edge_edge_2d:
      return edge(pair.first) + " crosses " + edge(pair.second);
    case audit::PairKind::vertex_obstacle:
      return vertex(pair.first) + " is on the wrong side of obstacle " +
             scene.obstacles[static_cast<std::size_t>(pair.second)].name;
    default:
      return fmt::format("pair {} {}", pair.first, pair.second);
  }
}

}  // namespace

std::optional<std::string> initial_intersection(const RunConfig& config, const Scene& scene) {
  ContactSystem contacts(scene, {config.contact.mollifier, config.contact.ccd_park});
  if (const auto overlap = contacts.check_initial(scene.x0)) {
    return fmt::format("{} (gap {:.3g} m)", overlap->text, overlap->gap);
  }
  const audit::AuditMesh mesh = make_audit_mesh(scene);
  audit::Audit judge(mesh);
  judge.check_state(scene.x0, 0);
  const audit::AuditLedger& ledger = judge.ledger();
  if (ledger.ok()) return std::nullopt;
  return ledger.first_bad ? describe(scene, mesh, *ledger.first_bad)
                          : std::string("a state that cannot be judged");
}

}  // namespace bb
