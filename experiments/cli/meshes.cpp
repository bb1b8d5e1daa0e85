// The verb meshes: mesh files as the program reads them, for the front end and for other programs.
// A request is a line of JSON on the standard input:
//   {"path": FILE, "names": answer with the objects and groups of the file, all of them, "name": what messages call it and whose extension decides (default: path),
//    "as": "frame" (default: any positions, as frames are judged) or "body" (the rules of a body's mesh),
//    "skin": of a body, keep triangles that are faces of one tetrahedron, "objects": of a body, [names of OBJ objects and groups] alone,
//    "fields": [names of fields of points], "uvs": of a frame, texture coordinates of an OBJ file and which of them corners have}
// An answer is a line of JSON, {"error": ...} or notes, objects and groups where they are requested, and the list of arrays, and then the numbers of these arrays, one after
// the other, little-endian and by rows.
#include <fmt/format.h>

#include <bit>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/base/input/json.hpp"
#include "core/base/input/read_file.hpp"
#include "core/model/mesh/frame_mesh.hpp"
#include "core/model/mesh/read_mesh.hpp"
#include "experiments/cli/options.hpp"

namespace bb::cli {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

/// The arrays of an answer: their names and shapes, and where their numbers lie.
class Arrays {
 public:
  template <class T>
  void add(const std::string& name, const T* numbers, std::size_t rows, std::size_t columns) {
    list_.push_back({{"name", name},
                     {"type", std::is_floating_point_v<T> ? "<f8" : "<i4"},
                     {"shape", columns == 0 ? Json{rows} : Json{rows, columns}}});
    parts_.emplace_back(reinterpret_cast<const char*>(numbers),
                        sizeof(T) * rows * std::max<std::size_t>(columns, 1));
  }
  template <class T, std::size_t N>
  void add(const std::string& name, const std::vector<std::array<T, N>>& cells) {
    add(name, cells.empty() ? nullptr : cells[0].data(), cells.size(), N);
  }
  void write(Json head) const {
    head["arrays"] = list_;
    std::cout << head.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
    for (const std::string_view part : parts_)
      std::cout.write(part.data(), static_cast<std::streamsize>(part.size()));
    std::cout.flush();
  }

 private:
  Json list_ = Json::array();
  std::vector<std::string_view> parts_;
};

/// Names of objects and groups, and how much of the file they are.
Json objects_json(const MeshObjects& objects) {
  Json out = Json::array();
  for (const MeshObject& one : objects.list) {
    out.push_back({{"name", one.name},
                   {"vertices", objects.file_vertices(one).size()},
                   {"faces", one.faces},
                   {"lines", one.lines}});
  }
  return out;
}

void answer_body(const std::string& bytes, const std::string& name, const nlohmann::json& request,
                 Json head) {
  const MeshFile file = parse_mesh_file(
      bytes, name, {request.value("skin", false), request.value("objects", std::vector<std::string>()), ""});
  const TriangleMesh& mesh = file.mesh;
  Arrays arrays;
  arrays.add("points", mesh.vertices.data(), static_cast<std::size_t>(mesh.n_vertices()), 3);
  arrays.add("triangles", mesh.triangles);
  arrays.add("segments", mesh.segments);
  arrays.add("tetrahedra", mesh.tetrahedra);
  head["notes"] = file.notes;
  arrays.write(std::move(head));
}

void answer_frame(const std::string& bytes, const std::string& name, const nlohmann::json& request,
                  Json head) {
  const auto wanted = request.value("fields", std::set<std::string, std::less<>>());
  const FrameMesh mesh = parse_frame(bytes, name, wanted, request.value("uvs", false));
  Arrays arrays;
  arrays.add("points", mesh.vertices.data(), static_cast<std::size_t>(mesh.vertices.cols()), 3);
  arrays.add("corners", mesh.corners.data(), mesh.corners.size(), 0);
  arrays.add("sizes", mesh.sizes.data(), mesh.sizes.size(), 0);
  arrays.add("triangles", mesh.triangles);
  arrays.add("segments", mesh.segments);
  arrays.add("tetrahedra", mesh.tetrahedra);
  if (request.value("uvs", false)) {
    arrays.add("uvs", mesh.uvs);
    arrays.add("corner_uvs", mesh.corner_uvs.data(), mesh.corner_uvs.size(), 0);
  }
  Json fields = Json::object();
  for (const FrameField& field : mesh.fields) {
    fields[field.name] = field.components;
    const auto width = static_cast<std::size_t>(field.components);
    if (wanted.contains(field.name))
      arrays.add("field " + field.name, field.values.data(), field.values.size() / width, width);
  }
  head["notes"] = mesh.notes;
  head["fields"] = fields;
  arrays.write(std::move(head));
}

void answer(const std::string& line) {
  const nlohmann::json request = parse_json(line, "a request");
  const std::string path = request.at("path"), name = request.value("name", path);
  const std::string bytes = read_input_file(path, mesh_file);
  Json head = Json::object();
  if (request.value("names", false)) head["objects"] = objects_json(parse_mesh_objects(bytes, name));
  if (request.value("as", "frame") == "body") return answer_body(bytes, name, request, std::move(head));
  answer_frame(bytes, name, request, std::move(head));
}

int answer_all() {
  for (std::string line; std::getline(std::cin, line);) {
    try {
      answer(line);
    } catch (const ConfigError& error) {
      std::cout << Json{{"error", error.what()}}.dump(-1, ' ', false, Json::error_handler_t::replace)
                << std::endl;
    } catch (const std::bad_alloc&) {
      std::cout << Json{{"error", "a mesh that the memory does not hold"}}.dump() << std::endl;
    } catch (const nlohmann::json::exception& error) {
      std::cout << Json{{"error", fmt::format("a request: {}", error.what())}}.dump() << std::endl;
    }
  }
  return exit_ok;
}

}  // namespace

Action verb::meshes(CLI::App& /*app*/) {
  return [](const CommonOptions&) { return answer_all(); };
}

}  // namespace bb::cli
