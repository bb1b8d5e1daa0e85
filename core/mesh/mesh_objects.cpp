#include "core/mesh/mesh_objects.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/input/names.hpp"
#include "core/math/error.hpp"
#include "core/mesh/raw_mesh.hpp"

namespace bb {
namespace {

constexpr std::size_t most_names = 20;  // of a message

std::string names_text(std::span<const MeshObject> objects) {
  if (objects.empty()) return "a mesh file with objects (o) or groups (g), which OBJ files can have";
  std::string out = "one of ";
  for (std::size_t i = 0; i < std::min(most_names, objects.size()); ++i) {
    out += (i == 0 ? "" : ", ") + shortened(objects[i].name);
  }
  if (objects.size() > most_names) out += fmt::format(", and {} more", objects.size() - most_names);
  return out;
}

void sort_once(std::vector<int>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

}  // namespace

const MeshObject& require_object(std::span<const MeshObject> objects, const std::string& name,
                                 const std::string& file, const std::string& where) {
  const auto found = std::find_if(objects.begin(), objects.end(),
                                  [&](const MeshObject& object) { return object.name == name; });
  if (found != objects.end()) return *found;
  throw ConfigError(where,
                    fmt::format("\"{}\", which no face or line {} has", shortened(name),
                                file.empty() ? "of the mesh" : "of " + file),
                    names_text(objects));
}

std::vector<MeshObject> objects_of(const RawMesh& raw) {
  std::vector<MeshObject> out(raw.object_names.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i].name = raw.object_names[i];
  const auto add = [&](std::size_t set, std::span<const long long> corners, long long MeshObject::*counter) {
    for (const std::size_t i : raw.object_sets[set]) {
      ++(out[i].*counter);
      for (const long long corner : corners) {
        const bool is_vertex = corner >= 0 && corner < static_cast<long long>(raw.vertices.size());
        if (is_vertex) out[i].vertices.push_back(static_cast<int>(corner));
      }
    }
  };
  for (std::size_t p = 0; p < raw.polygon_objects.size(); ++p) {
    const std::size_t begin = raw.first_corner[p];
    add(raw.polygon_objects[p], std::span(raw.corners).subspan(begin, raw.end_corner(p) - begin),
        &MeshObject::faces);
  }
  for (std::size_t s = 0; s < raw.segment_objects.size(); ++s) {
    add(raw.segment_objects[s], raw.segments[s], &MeshObject::lines);
  }
  std::erase_if(out, [](const MeshObject& object) { return object.faces + object.lines == 0; });
  for (MeshObject& object : out) sort_once(object.vertices);
  return out;
}

RawMesh only_objects(RawMesh raw, const MeshChoice& choice) {
  const std::vector<MeshObject> objects = objects_of(raw);
  std::vector<char> is_wanted(raw.object_names.size(), 0);
  for (const std::string& name : choice.objects) {
    require_object(objects, name, raw.name, choice.where.empty() ? raw.name : choice.where);
    for (std::size_t i = 0; i < is_wanted.size(); ++i) is_wanted[i] |= raw.object_names[i] == name;
  }
  const auto has_wanted = [&](std::size_t set) {
    return std::any_of(raw.object_sets[set].begin(), raw.object_sets[set].end(),
                       [&](std::size_t object) { return is_wanted[object] != 0; });
  };
  const auto keep = [&](std::size_t set, const char* what, long long place) {
    if (!has_wanted(set)) count_one(raw.left_out, what, place);
    return has_wanted(set);
  };
  raw.keep_polygons([&](std::size_t p) {
    return keep(raw.polygon_objects[p], "a face of another object", raw.polygon_place[p]);
  });
  raw.keep_segments([&](std::size_t s) {
    return keep(raw.segment_objects[s], "a line of another object", raw.segment_place[s]);
  });
  return without_loose_vertices(std::move(raw));
}

}  // namespace bb
