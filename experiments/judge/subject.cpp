#include "experiments/judge/subject.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/audit/surface_edges.hpp"
#include "core/base/input/json.hpp"
#include "core/math/direction.hpp"
#include "core/math/error.hpp"

namespace bb::judge {
namespace {

using nlohmann::json;

constexpr InputKind subject_file{"a subject of judge (.json)", std::uint64_t{4} << 30};
constexpr int most_vertices = 100'000'000;
constexpr double most_metres = 1e15;

std::string shown(const json& value) {
  const std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  return text.size() > 60 ? text.substr(0, 60) + "..." : text;
}

/// Reads keys of one object and remembers which keys were requested.
class Keys {
 public:
  Keys(const json& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object.is_object()) throw ConfigError(where_, shown(object), "an object");
  }

  const json* find(const char* key) {
    known_.emplace_back(key);
    return object_.contains(key) ? &object_[key] : nullptr;
  }
  std::string at(const std::string& key) const {
    return where_ + (where_.find('#') < where_.size() ? "/" : "#/") + key;
  }

  double number(const char* key, double low, double high, double absent) {
    const json* value = find(key);
    return value ? number_of(*value, at(key), low, high) : absent;
  }
  int integer(const char* key, int low, int high) {
    const json* value = find(key);
    if (!value) throw ConfigError(at(key), "nothing", fmt::format("an integer from {} to {}", low, high));
    return integer_of(*value, at(key), low, high);
  }
  bool flag(const char* key) {
    const json* value = find(key);
    if (value && !value->is_boolean()) throw ConfigError(at(key), shown(*value), "true or false");
    return value && value->get<bool>();
  }
  std::string word(const char* key, const char* allowed) {
    const json* value = find(key);
    if (!value || !value->is_string()) throw ConfigError(at(key), value ? shown(*value) : "nothing", allowed);
    return value->get<std::string>();
  }
  Vec3d vector(const char* key, const Vec3d& absent, double most = most_metres) {
    const json* value = find(key);
    if (!value) return absent;
    if (!value->is_array() || value->size() != 3) throw ConfigError(at(key), shown(*value), "three numbers");
    Vec3d out;
    for (int k = 0; k < 3; ++k)
      out[k] = number_of((*value)[static_cast<std::size_t>(k)], at(key), -most, most);
    return out;
  }
  /// Items of a list, none where it is absent: item(value, place).
  template <class F>
  void each(const char* key, F&& item) {
    const json* list = find(key);
    if (!list) return;
    if (!list->is_array()) throw ConfigError(at(key), shown(*list), "an array");
    for (std::size_t i = 0; i < list->size(); ++i) item((*list)[i], at(fmt::format("{}/{}", key, i)));
  }
  /// Errors: ConfigError for a key that was never requested.
  void finish() const {
    for (const auto& [key, value] : object_.items()) {
      if (std::find(known_.begin(), known_.end(), key) == known_.end())
        throw ConfigError(at(key), "an unknown key", fmt::format("{}", fmt::join(known_, ", ")));
    }
  }

  static double number_of(const json& value, const std::string& where, double low, double high) {
    if (value.is_number() && value.get<double>() >= low && value.get<double>() <= high)
      return value.get<double>();
    throw ConfigError(where, shown(value), fmt::format("a number from {:g} to {:g}", low, high));
  }
  static int integer_of(const json& value, const std::string& where, int low, int high) {
    if (value.is_number_integer() && value.get<std::int64_t>() >= low && value.get<std::int64_t>() <= high)
      return value.get<int>();
    throw ConfigError(where, shown(value), fmt::format("an integer from {} to {}", low, high));
  }

 private:
  const json& object_;
  std::string where_;
  std::vector<std::string> known_;
};

/// Rows of n different vertex numbers.
template <std::size_t n>
std::vector<std::array<int, n>> rows(Keys& keys, const char* key, int n_vertices) {
  std::vector<std::array<int, n>> out;
  keys.each(key, [&](const json& row, const std::string& where) {
    if (!row.is_array() || row.size() != n)
      throw ConfigError(where, shown(row), fmt::format("{} vertex numbers", n));
    std::array<int, n> ids{};
    for (std::size_t k = 0; k < n; ++k) ids[k] = Keys::integer_of(row[k], where, 0, n_vertices - 1);
    for (std::size_t k = 0; k < n; ++k) {
      if (std::find(ids.begin() + static_cast<std::ptrdiff_t>(k) + 1, ids.end(), ids[k]) != ids.end())
        throw ConfigError(where, shown(row), "different vertices");
    }
    out.push_back(ids);
  });
  return out;
}

void read_bodies(Keys& keys, Subject& out) {
  keys.each("bodies", [&](const json& value, const std::string& where) {
    Keys body(value, where);
    out.names.bodies.push_back(body.word("name", "a name"));
    const int low = out.names.first_vertex.empty() ? 0 : out.names.first_vertex.back() + 1;
    const int high = out.names.first_vertex.empty() ? 0 : out.n_vertices - 1;
    out.names.first_vertex.push_back(body.integer("first_vertex", low, high));
    body.finish();
  });
  if (out.names.bodies.empty()) out.names.bodies = {"surface"}, out.names.first_vertex = {0};
}

void read_obstacles(Keys& keys, Subject& out) {
  const std::map<std::string, audit::ObstacleKind> kinds{{"plane", audit::ObstacleKind::plane},
                                                         {"sphere", audit::ObstacleKind::sphere},
                                                         {"cylinder", audit::ObstacleKind::cylinder}};
  keys.each("obstacles", [&](const json& value, const std::string& where) {
    Keys given(value, where);
    const std::string kind = given.word("kind", "plane, sphere or cylinder");
    if (!kinds.contains(kind)) throw ConfigError(where + "/kind", kind, "plane, sphere or cylinder");
    audit::AuditObstacle obstacle;
    obstacle.kind = kinds.at(kind);
    obstacle.point = given.vector("point_m", Vec3d::Zero());
    obstacle.axis = given.vector("axis", Vec3d::UnitZ(), std::numeric_limits<double>::max());
    const bool round = obstacle.kind != audit::ObstacleKind::plane;
    obstacle.radius = given.number("radius_m", 0.0, most_metres, 0.0);
    obstacle.inside = given.flag("inside");
    if (round && !(obstacle.radius > 0)) throw ConfigError(where + "/radius_m", "no radius", "a number > 0");
    if (obstacle.axis.isZero(0))
      throw ConfigError(where + "/axis", "no direction", "a vector that is not zero");
    obstacle.axis = of_usual_size(obstacle.axis);
    if (const json* vertex = given.find("vertex")) {
      obstacle.vertex = Keys::integer_of(*vertex, where + "/vertex", 0, out.n_vertices - 1);
      out.mesh.prescribed.resize(static_cast<std::size_t>(out.n_vertices), 0);
      out.mesh.prescribed[static_cast<std::size_t>(obstacle.vertex)] = 1;
    }
    out.mesh.obstacles.push_back(obstacle);
    const json* name = given.find("name");
    if (name && !name->is_string()) throw ConfigError(where + "/name", shown(*name), "a name");
    out.names.obstacles.push_back(name ? name->get<std::string>()
                                       : fmt::format("{} {}", kind, out.names.obstacles.size()));
    given.finish();
  });
}

void read_vertices(Keys& keys, Subject& out) {
  const auto n = static_cast<std::size_t>(out.n_vertices);
  keys.each("given", [&](const json& value, const std::string& where) {
    out.mesh.prescribed.resize(n, 0);
    out.mesh.prescribed[static_cast<std::size_t>(Keys::integer_of(value, where, 0, out.n_vertices - 1))] = 1;
  });
  keys.each("half_thickness_m", [&](const json& value, const std::string& where) {
    out.mesh.thickness.push_back(Keys::number_of(value, where, 0.0, most_metres));
  });
  const std::size_t found = out.mesh.thickness.size();
  if (found != 0 && found != n)
    throw ConfigError(keys.at("half_thickness_m"), fmt::format("{} numbers", found), fmt::format("{}", n));
}

void read_elastic(Keys& keys, Subject& out) {
  const json* value = keys.find("elastic");
  if (!value) return;
  Keys given(*value, keys.at("elastic"));
  ElasticPart part;
  part.config = given.word("config", "the path of a config");
  given.each("vertices", [&](const json& vertex, const std::string& where) {
    part.vertices.push_back(Keys::integer_of(vertex, where, 0, out.n_vertices - 1));
  });
  given.finish();
  out.elastic = std::move(part);
}

/// Vertices of no triangle and no segment; those that obstacles move with are no part of the surface.
void set_particles(Subject& out) {
  std::vector<int> all(static_cast<std::size_t>(out.n_vertices));
  std::iota(all.begin(), all.end(), 0);
  std::erase_if(all, [&out](int v) {
    const auto& obstacles = out.mesh.obstacles;
    return std::any_of(obstacles.begin(), obstacles.end(), [v](const auto& o) { return o.vertex == v; });
  });
  audit::set_points(all, out.n_vertices, out.mesh);
}

}  // namespace

Subject read_subject(const std::string& path) {
  const json document = read_json_file(path, subject_file);
  Keys keys(document, path);
  const std::string schema = keys.word("schema", subject_schema);
  if (schema != subject_schema) throw ConfigError(keys.at("schema"), schema, subject_schema);
  Subject out;
  out.n_vertices = keys.integer("n_vertices", 1, most_vertices);
  out.reach_m = keys.number("reach_m", 0.0, most_metres, 0.0);
  out.tolerance_m = keys.number("tolerance_m", 0.0, most_metres, 0.0);
  out.mesh.planar = keys.flag("planar");
  const auto triangles = rows<3>(keys, "triangles", out.n_vertices);
  const auto segments = rows<2>(keys, "segments", out.n_vertices);
  audit::set_edges(triangles, segments, out.mesh);
  out.mesh.triangles = audit::as_columns(triangles);
  read_bodies(keys, out);
  read_obstacles(keys, out);
  read_vertices(keys, out);
  read_elastic(keys, out);
  set_particles(out);
  keys.finish();
  if (triangles.empty() && segments.empty() && out.mesh.obstacles.empty()) {
    throw ConfigError(path, "no triangle, no segment and no obstacle",
                      "a subject of which something can be judged");
  }
  return out;
}

}  // namespace bb::judge
