#include "core/model/mesh/mesh_objects.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/input/names.hpp"
#include "core/math/error.hpp"
#include "core/model/mesh/raw_mesh.hpp"

namespace bb {
namespace {

void sort_once(std::vector<int>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

std::string names_text(std::span<const MeshObject> objects) {
  if (objects.empty()) return "a mesh file with objects (o) or groups (g), which OBJ files can have";
  std::vector<std::string> names;
  for (const MeshObject& object : objects) names.push_back(shortened(object.name));
  return "one of " + listed(names);
}

}  // namespace

std::string listed(std::span<const std::string> names) {
  const std::string first =
      fmt::format("{}", fmt::join(names.first(std::min(most_listed, names.size())), ", "));
  return names.size() > most_listed ? fmt::format("{}, and {} more", first, names.size() - most_listed)
                                    : first;
}

std::vector<int> MeshObjects::file_vertices(const MeshObject& object) const {
  std::vector<int> out;
  for (const std::size_t set : object.sets) {
    out.insert(out.end(), set_vertices[set].begin(), set_vertices[set].end());
  }
  if (object.sets.size() > 1) sort_once(out);
  return out;
}

std::vector<int> MeshObjects::mesh_vertices(const MeshObject& object) const {
  std::vector<int> out = file_vertices(object);
  if (mesh_vertex.empty()) return out;
  for (int& vertex : out) vertex = mesh_vertex[static_cast<std::size_t>(vertex)];
  std::erase(out, -1);
  return out;
}

const MeshObject& MeshObjects::require(const std::string& name, const std::string& file,
                                       const std::string& where) const {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const MeshObject& object) { return object.name == name; });
  if (found != list.end()) return *found;
  throw ConfigError(where,
                    fmt::format("\"{}\", which no face or line {} has", shortened(name),
                                file.empty() ? "of the mesh" : "of " + file),
                    names_text(list));
}

MeshObjects objects_of(const RawMesh& raw) {
  MeshObjects out;
  out.set_vertices.resize(raw.object_sets.size());
  std::vector<long long> faces(raw.object_sets.size()), lines(raw.object_sets.size());
  const auto add = [&](std::size_t set, std::span<const long long> corners) {
    for (const long long corner : corners) {
      const bool is_vertex = corner >= 0 && corner < static_cast<long long>(raw.vertices.size());
      if (is_vertex) out.set_vertices[set].push_back(static_cast<int>(corner));
    }
  };
  for (std::size_t p = 0; p < raw.polygon_objects.size(); ++p) {
    const std::size_t set = raw.polygon_objects[p], begin = raw.first_corner[p];
    if (raw.object_sets[set].empty()) continue;
    add(set, std::span(raw.corners).subspan(begin, raw.end_corner(p) - begin));
    ++faces[set];
  }
  for (std::size_t s = 0; s < raw.segment_objects.size(); ++s) {
    const std::size_t set = raw.segment_objects[s];
    if (raw.object_sets[set].empty()) continue;
    add(set, raw.segments[s]);
    ++lines[set];
  }
  for (const std::string& name : raw.object_names) out.list.push_back({name, {}, 0, 0});
  for (std::size_t set = 0; set < raw.object_sets.size(); ++set) {
    sort_once(out.set_vertices[set]);
    for (const std::size_t i : raw.object_sets[set]) {
      out.list[i].sets.push_back(set);
      out.list[i].faces += faces[set];
      out.list[i].lines += lines[set];
    }
  }
  std::erase_if(out.list, [](const MeshObject& object) { return object.sets.empty(); });
  return out;
}

RawMesh only_objects(RawMesh raw, const MeshChoice& choice, MeshObjects& objects) {
  std::vector<char> is_wanted(raw.object_sets.size(), 0);
  for (std::size_t i = 0; i < choice.objects.size(); ++i) {
    const std::string where = choice.where.empty() ? raw.name : fmt::format("{}/{}", choice.where, i);
    for (const std::size_t set : objects.require(choice.objects[i], raw.name, where).sets) is_wanted[set] = 1;
  }
  const auto keep = [&](std::size_t set, const char* what, long long place) {
    if (is_wanted[set] == 0) count_one(raw.left_out, what, place);
    return is_wanted[set] != 0;
  };
  raw.keep_polygons([&](std::size_t p) {
    return keep(raw.polygon_objects[p], "a face of another object", raw.polygon_place[p]);
  });
  raw.keep_segments([&](std::size_t s) {
    return keep(raw.segment_objects[s], "a line of another object", raw.segment_place[s]);
  });
  objects.mesh_vertex.assign(raw.vertices.size(), -1);
  raw = without_loose_vertices(std::move(raw));
  for (std::size_t v = 0; v < raw.numbers.size(); ++v) {
    objects.mesh_vertex[static_cast<std::size_t>(raw.numbers[v] - raw.first_number)] = static_cast<int>(v);
  }
  return raw;
}

}  // namespace bb
