#include "core/audit/pair_text.hpp"

#include <algorithm>
#include <array>

namespace bb::audit {

std::string SubjectNames::vertices(std::span<const int> ids) const {
  const auto after = std::upper_bound(first_vertex.begin(), first_vertex.end(), ids.front());
  const auto body = static_cast<std::size_t>(after - first_vertex.begin()) - 1;
  std::string text = bodies[body] + "[";
  for (const int v : ids) {
    if (text.back() != '[') text += ' ';
    text += std::to_string(v - first_vertex[body]);
  }
  return text + "]";
}

std::string describe(const AuditMesh& mesh, const PairName& pair, const SubjectNames& names) {
  const auto edge = [&](int i) {
    return "edge " + names.vertices(std::array{mesh.edges(0, i), mesh.edges(1, i)});
  };
  const auto triangle = [&](int i) {
    return "triangle " +
           names.vertices(std::array{mesh.triangles(0, i), mesh.triangles(1, i), mesh.triangles(2, i)});
  };
  const auto vertex = [&](int v) { return "vertex " + names.vertices(std::array{v}); };
  const auto obstacle = [&](int i) { return names.obstacles[static_cast<std::size_t>(i)]; };
  const std::string enters =
      pair.proven ? " enters obstacle " : " cannot be certified not to enter obstacle ";
  const std::string passes = pair.proven ? " passes through " : " cannot be certified not to pass through ";
  switch (pair.kind) {
    case PairKind::edge_triangle:
      return edge(pair.first) + " crosses " + triangle(pair.second);
    case PairKind::edge_edge_2d:
      return edge(pair.first) + " crosses " + edge(pair.second);
    case PairKind::vertex_triangle:
      return vertex(pair.first) + passes + triangle(pair.second);
    case PairKind::edge_edge:
      return edge(pair.first) + passes + edge(pair.second);
    case PairKind::vertex_edge_2d:
      return vertex(pair.first) + passes + edge(pair.second);
    case PairKind::vertex_obstacle:
      return vertex(pair.first) + " is on the wrong side of obstacle " + obstacle(pair.second);
    case PairKind::edge_obstacle:
      return edge(pair.first) + enters + obstacle(pair.second);
    case PairKind::triangle_obstacle:
      return triangle(pair.first) + enters + obstacle(pair.second);
    case PairKind::inverted:
      return triangle(pair.first) + " is inverted";
  }
  return {};
}

}  // namespace bb::audit
