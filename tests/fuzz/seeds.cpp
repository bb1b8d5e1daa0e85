#include "tests/fuzz/seeds.hpp"

#include <elf.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "core/base/record/schema.hpp"
#include "core/base/record/writer.hpp"
#include "core/step_solvers/registry.hpp"
#include "experiments/config/config_list.hpp"
#include "experiments/eval/eval.hpp"
#include "experiments/matrix/matrix_market.hpp"
#include "experiments/matrix/system_file.hpp"
#include "tests/folders.hpp"
#include "tests/fuzz/eval_lines.hpp"
#include "tests/matrix/stored.hpp"
#include "tests/mesh/mesh_bytes.hpp"
#include "tests/record/sample_record.hpp"

namespace bb::fuzz {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Texts = std::vector<std::string>;

constexpr std::size_t most_bytes = 16384;

/// Every file of a folder of the sources with this suffix, JSON without its blanks; those that are too long are left out.
Texts files(const char* folder, const char* suffix) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(fs::path(BB_SOURCE_DIR) / folder)) {
    if (entry.path().extension() == suffix) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  Texts out;
  for (const fs::path& path : paths) {
    std::ifstream in(path, std::ios::binary);
    std::string text(std::istreambuf_iterator<char>(in), {});
    if (std::string_view(suffix) == ".json") text = Json::parse(text).dump();
    if (text.size() <= most_bytes) out.push_back(std::move(text));
  }
  if (out.empty()) throw std::runtime_error(std::string("no seed in ") + folder);
  return out;
}

Texts configs() {
  Texts out = files("configs/scenes", ".json");
  for (const std::string& text : files("examples/scenes", ".json")) out.push_back(text);
  // Presets as configs of their own, so that policies and shapes are met.
  for (const std::string& text : files("configs/formulations", ".json")) {
    const Json preset = Json::parse(text);
    out.push_back(Json{{"schema", "barrierbench.config/1"},
                       {"scene", {{"name", "hang"}}},
                       {"formulation", preset["formulation"]}}
                      .dump());
  }
  return out;
}

StoredSystem small_system() {
  StoredSystem out = chain(7, 2.5);
  out.system.block_vertex = {4, 5, 9};
  out.coordinates = {{0.1, -0.2, 0.3}, {1.0 / 3, 2, 3}, {4, 5, 6}};
  out.origin = {"drape", "log", "bdf2", "abc", 0.01, 3, 4, "solved", "contact"};
  out.cond = {{Scaling::none, 2, ConditionStatus::ok, 9.5, 0.5, 4.5}};
  return out;
}

Texts side_cars() {
  StoredSystem system = small_system();
  const std::string whole = side_car_text(system, "fuzz.mtx", "");
  Json without_hash = Json::parse(whole);
  without_hash.erase("matrix");
  return {without_hash.dump(), whole,
          R"({"schema":"barrierbench.matrix/1","block_size":1,"rhs":[1,2,3,4,5,6,7]})"};
}

template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// The smallest file that the check accepts: a header, one segment, one section.
std::string small_library() {
  Elf64_Ehdr header{};
  std::copy_n(ELFMAG, SELFMAG, header.e_ident);
  header.e_ident[EI_CLASS] = ELFCLASS64;
  header.e_type = ET_DYN;
  header.e_phoff = sizeof(Elf64_Ehdr);
  header.e_phnum = 1;
  header.e_phentsize = sizeof(Elf64_Phdr);
  header.e_shoff = sizeof(Elf64_Ehdr) + sizeof(Elf64_Phdr);
  header.e_shnum = 1;
  header.e_shentsize = sizeof(Elf64_Shdr);
  Elf64_Phdr segment{};
  segment.p_filesz = header.e_shoff;
  std::string bytes;
  put(bytes, header);
  put(bytes, segment);
  put(bytes, Elf64_Shdr{});
  return bytes;
}

/// One point through a triangle.
std::string ccd_queries() {
  std::string out;
  for (const char* height : {"1,2", "-1,4"}) {
    out += "0,1,0,1," + std::string(height) + ",1\n0,1,0,1,0,1,1\n1,1,0,1,0,1,1\n0,1,1,3,0,1,1\n";
  }
  return out;
}

Texts eval_seeds() {
  Texts out;
  for (const char* line : eval_lines) out.emplace_back(line);
  return out;
}

/// One triangle, its points compressed by zlib: a header of one block, 72 bytes that become 17.
std::string compressed_vtu() {
  return "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" "
         "compressor=\"vtkZLibDataCompressor\"><UnstructuredGrid>"
         "<Piece NumberOfPoints=\"3\" NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" "
         "Name=\"Points\" "
         "NumberOfComponents=\"3\" "
         "format=\"binary\">AQAAAEgAAAAAAAAAEQAAAA==eNpjYMAHPtgzECkPAD1WAl8=</DataArray></Points><Cells>" +
         test::data_array("Int64", "connectivity", 1, "0 1 2") +
         test::data_array("Int64", "offsets", 1, "3") + test::data_array("UInt8", "types", 1, "5") +
         "</Cells></Piece></UnstructuredGrid></VTKFile>";
}

constexpr std::size_t largest_sweep_seed = 8000;  // bytes

const std::map<std::string, Texts (*)()>& makers() {
  static const std::map<std::string, Texts (*)()> all{
      {"ccd_queries", [] { return Texts{ccd_queries()}; }},
      {"config", configs},
      {"sweep",
       [] {
         // A factorial has thousands of cases, and every input made of it would take as long.
         Texts out = files("configs/sweeps", ".json");
         std::erase_if(out, [](const std::string& text) { return text.size() > largest_sweep_seed; });
         return out;
       }},
      {"mesh_obj",
       [] {
         Texts out = files("examples/scenes", ".obj");
         out.push_back(test::tetrahedron_obj());
         out.emplace_back("v 0 0 0\nv 1 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\nl 1 2 3\n");
         return out;
       }},
      {"mesh_ply",
       [] {
         return Texts{test::tetrahedron_ply_ascii(), test::tetrahedron_ply_binary<float>(false),
                      test::tetrahedron_ply_binary<double>(true)};
       }},
      {"mesh_stl",
       [] {
         return Texts{test::tetrahedron_stl_ascii(), test::tetrahedron_stl_binary()};
       }},
      {"mesh_msh",
       [] {
         return Texts{test::tetrahedron_msh_22(), test::tetrahedron_msh_41(),
                      test::tetrahedron_msh_22_binary(), test::tetrahedron_msh_41_binary()};
       }},
      {"mesh_vtk",
       [] {
         return Texts{test::tetrahedron_vtk_ascii(), test::tetrahedron_vtk_binary()};
       }},
      {"mesh_vtp", [] { return Texts{test::tetrahedron_vtp_ascii()}; }},
      {"mesh_vtu",
       [] {
         return Texts{test::tetrahedron_vtu_ascii(), test::tetrahedron_vtu_appended(), compressed_vtu()};
       }},
      {"record", [] { return Texts{Json::parse(to_json(test::sample_record())).dump()}; }},
      {"trace", [] { return Texts{to_json(test::sample_trace_row())}; }},
      {"matrix",
       [] {
         return Texts{
             matrix_market_text(small_system().system.lower),
             "%%MatrixMarket matrix coordinate real general\n% both\n2 2 4\n1 1 2\n1 2 -1\n2 1 -1\n2 2 2\n"};
       }},
      {"side_car", side_cars},
      {"eval", eval_seeds},
      {"library", [] { return Texts{small_library()}; }}};
  return all;
}

void collect(const ParameterList& list, Texts& out) {
  for (const Parameter& row : list.rows) {
    out.push_back('"' + row.name + '"');
    if (row.rule.words) {
      for (const std::string& word : row.rule.words()) out.push_back('"' + word + '"');
    }
    if (row.rule.list) collect(row.rule.list(nlohmann::json::object()), out);
  }
}

/// Names of properties and words of enums, wherever a JSON Schema has them.
void collect(const Json& schema, Texts& out) {
  if (schema.is_object()) {
    for (const auto& [key, value] : schema.items()) {
      if (key == "properties" && value.is_object()) {
        for (const auto& [name, rule] : value.items()) out.push_back('"' + name + '"');
      }
      if (key == "enum" && value.is_array()) {
        for (const Json& word : value) out.push_back(word.dump());
      }
    }
  }
  if (schema.is_structured()) {
    for (const Json& part : schema) collect(part, out);
  }
}

Texts of_schema(const std::string& schema) {
  Texts out;
  collect(Json::parse(schema), out);
  return out;
}

}  // namespace

const std::vector<std::string>& target_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const auto& [name, make] : makers()) out.push_back(name);
    return out;
  }();
  return names;
}

std::vector<std::string> seeds_of(const std::string& target) { return makers().at(target)(); }

std::vector<std::string> words_of(const std::string& target) {
  Texts out;
  if (target == "config") collect(config_list(), out);
  if (target == "sweep") collect(sweep_list(), out);
  if (target == "record") out = of_schema(run_schema(step_solver_counters()));
  if (target == "trace") out = of_schema(trace_schema());
  if (target == "eval") {
    std::ostringstream schema;
    print_eval_schema(schema);
    out = of_schema(schema.str());
  }
  if (target == "mesh_ply") {
    out = {"element",
           "property",
           "list",
           "vertex",
           "face",
           "edge",
           "vertex_indices",
           "vertex_index",
           "uchar",
           "int",
           "float",
           "double",
           "end_header",
           "binary_big_endian",
           "binary_little_endian",
           "ascii"};
  }
  if (target == "mesh_stl")
    out = {"solid", "facet normal", "outer loop", "vertex", "endloop", "endfacet", "endsolid"};
  if (target == "mesh_msh") {
    out = {"$MeshFormat",  "$EndMeshFormat", "$Nodes",  "$EndNodes", "$Elements",
           "$EndElements", "2.2 0 8",        "4.1 0 8", "4.1 1 8"};
  }
  if (target == "mesh_vtk") {
    out = {"POINTS",   "CELLS",        "CELL_TYPES", "POLYGONS", "LINES",   "TRIANGLE_STRIPS",
           "OFFSETS",  "CONNECTIVITY", "POINT_DATA", "VECTORS",  "SCALARS", "FIELD",
           "METADATA", "vtktypeint64", "double",     "BINARY",   "ASCII"};
  }
  if (target == "mesh_vtu" || target == "mesh_vtp") {
    out = {"<DataArray",
           "</DataArray>",
           "<Piece",
           "</Piece>",
           "<PointData>",
           "NumberOfPoints=",
           "NumberOfCells=",
           "NumberOfStrips=",
           "NumberOfComponents=",
           "format=\" appended\"",
           "format=\" binary\"",
           "offset=",
           "<AppendedData",
           "encoding=\" base64\"",
           "Float64",
           "UInt8",
           "header_type=\" UInt64\""};
  }
  if (target == "matrix")
    out = {"%%MatrixMarket", "matrix", "coordinate", "real", "integer", "symmetric", "general"};
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace bb::fuzz
