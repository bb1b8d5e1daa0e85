// Malformed meshes: each is refused with its place, what was found and what is allowed.
#include <gtest/gtest.h>

#include <ostream>

#include "core/math/error.hpp"
#include "core/model/mesh/read_mesh.hpp"
#include "tests/folders.hpp"
#include "tests/mesh/mesh_bytes.hpp"

namespace bb {

struct BadMesh {
  std::string label, name, bytes, where, found;
};
void PrintTo(const BadMesh& mesh, std::ostream* out) { *out << mesh.label; }

namespace {

using namespace test;

class Malformed : public ::testing::TestWithParam<BadMesh> {};

TEST_P(Malformed, is_refused_with_its_place) {
  const BadMesh& mesh = GetParam();
  try {
    parse_mesh(mesh.bytes, mesh.name);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    ASSERT_FALSE(error.violations().empty());
    EXPECT_EQ(error.violations().front().where, mesh.where);
    EXPECT_NE(error.violations().front().found.find(mesh.found), std::string::npos)
        << error.violations().front().found;
    EXPECT_FALSE(error.violations().front().allowed.empty());
  }
}

const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";
const std::string ply_start =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
const std::string ply_faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

const std::string corner_list = "property list uchar int vertex_indices\n";

/// A whole header of three vertices with more elements behind them, and three vertices.
std::string announcing(const std::string& more) {
  return ply_start + more + "end_header\n0 0 0\n1 0 0\n0 1 0\n";
}

/// PREFIX0SUFFIX PREFIX1SUFFIX ...
std::string many(const std::string& prefix, int n, const std::string& suffix) {
  std::string out;
  for (int i = 0; i < n; ++i) out += prefix + std::to_string(i) + suffix;
  return out;
}

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  return text.replace(text.find(old), old.size(), by);
}

/// A copy of a binary file with `value` at a place.
template <class T>
std::string with(std::string bytes, std::size_t at, T value) {
  std::string raw;
  append(raw, value, false);
  return bytes.replace(at, raw.size(), raw);
}
const std::string ply_binary = tetrahedron_ply_binary<double>(false);
const std::size_t ply_body = ply_binary.find("end_header\n") + 11;
const std::size_t ply_first_face = ply_body + 4 * 25;

INSTANTIATE_TEST_SUITE_P(
    obj, Malformed,
    ::testing::Values(
        BadMesh{"word", "a.obj", "v 0 0 zero\n", "a.obj:1", "\"zero\""},
        BadMesh{"short_vertex", "a.obj", points + "v 1 2\n", "a.obj:5", "3 words"},
        BadMesh{"overflow", "a.obj", "v 0 0 1e999\n", "a.obj:1", "1e999"},
        BadMesh{"nan", "a.obj", "v 0 0 0\nv nan 0 0\n", "a.obj:2", "nan"},
        BadMesh{"inf", "a.obj", "v 0 0 0\nv 0 -inf 0\n", "a.obj:2", "inf"},
        BadMesh{"high_index", "a.obj", points + "f 1 2 5\n", "a.obj:5", "vertex 5"},
        BadMesh{"zero_index", "a.obj", points + "f 0 1 2\n", "a.obj:5", "\"0\""},
        BadMesh{"low_index", "a.obj", points + "f -5 1 2\n", "a.obj:5", "\"-5\" after 4 vertices"},
        BadMesh{"index_word", "a.obj", points + "f 1 2 x\n", "a.obj:5", "\"x\""},
        BadMesh{"two_corners", "a.obj", points + "f 1 2\n", "a.obj:5", "2 corners"},
        BadMesh{"repeated_index", "a.obj", points + "f 1 2 2\n", "a.obj:5", "vertex 2 twice"},
        BadMesh{"zero_area", "a.obj", "v 0 0 0\nv 1 1 1\nv 3 3 3\nf 1 2 3\n", "a.obj:4", "zero area"},
        BadMesh{"rounded_zero_area", "a.obj", "v 0 0 0\nv 0.1 0.2 0.3\nv 0.3 0.6 0.9\nf 1 2 3\n", "a.obj:4",
                "zero area"},
        BadMesh{"repeated_face", "a.obj", points + "f 1 2 3\n\nf 2 1 3\n", "a.obj:7", "same corners"},
        BadMesh{"no_fan", "a.obj",
                "v 0 0 0\nv 3 0 0\nv 3 1 0\nv 2 0.5 0\nv 1 0.5 0\nv 0 1 0\nv -1 3 0\nv -1 -3 0\nf 1 2 3 4 5 "
                "6 7 8\n",
                "a.obj:9", "not convex"},
        BadMesh{"unknown_word", "a.obj", points + "q 1 2 3\n", "a.obj:5", "begins with \"q\""},
        BadMesh{"free_form", "a.obj", points + "surf 0 1 0 1 1 2 3 4\n", "a.obj:5", "free form (surf)"},
        BadMesh{"huge_index", "a.obj", points + "f 1 2 2147483648\n", "a.obj:5", "vertex 2147483648"},
        BadMesh{"lone_point", "a.obj", points + "l 1\n", "a.obj:5", "one point"},
        BadMesh{"loop_edge", "a.obj", points + "l 1 1\n", "a.obj:5", "twice"},
        BadMesh{"repeated_edge", "a.obj", points + "l 1 2\nl 2 1\n", "a.obj:6", "same vertices"},
        BadMesh{"far", "a.obj", "v 0 0 0\nv 1e154 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj:2", "1e+154"},
        BadMesh{"just_too_far", "a.obj", "v 0 0 0\nv 0 -1.0000001e15 0\nv 0 1 0\nf 1 2 3\n", "a.obj:2",
                "-1000000100000000"},
        BadMesh{"empty", "a.obj", "", "a.obj", "no vertex"}),
    [](const auto& one) { return one.param.label; });

INSTANTIATE_TEST_SUITE_P(
    ply, Malformed,
    ::testing::Values(
        BadMesh{"no_magic", "a.ply", "plx\n", "a.ply:1", "no \"ply\""},
        BadMesh{"format", "a.ply", "ply\nformat text 1.0\n", "a.ply:2", "\"text\""},
        BadMesh{"no_format", "a.ply", "ply\nend_header\n", "a.ply:2", "no format"},
        BadMesh{"type", "a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\n", "a.ply:4",
                "\"real\""},
        BadMesh{"count", "a.ply", "ply\nformat ascii 1.0\nelement vertex -1\n", "a.ply:3", "-1"},
        BadMesh{"header_word", "a.ply", "ply\nformat ascii 1.0\nelements vertex 1\n", "a.ply:3",
                "\"elements\""},
        BadMesh{"open_header", "a.ply", ply_start, "a.ply", "without end_header"},
        BadMesh{
            "no_z", "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n",
            "a.ply", "without property z"},
        BadMesh{"no_corners", "a.ply", ply_start + "element face 1\nproperty int flags\nend_header\n",
                "a.ply", "without its corners"},
        BadMesh{"truncated", "a.ply", ply_start + ply_faces + "0 0 0\n1 0 0\n", "a.ply", "end of the file"},
        BadMesh{"truncated_late", "a.ply", ply_start + ply_faces + "0.000000 0 0\n1.00000 0 0\n",
                "a.ply: vertex 2", "end of the file"},
        BadMesh{"short_line", "a.ply", ply_start + ply_faces + "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "a.ply:11",
                "2 words"},
        BadMesh{"long_line", "a.ply", ply_start + ply_faces + "0 0 0\n1 0 0 9\n0 1 0\n3 0 1 2\n", "a.ply:11",
                "4 words"},
        BadMesh{"fraction", "a.ply", ply_start + ply_faces + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2.5\n", "a.ply:13",
                "\"2.5\""},
        BadMesh{"index", "a.ply", ply_start + ply_faces + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.ply:13",
                "vertex 3"},
        BadMesh{"format_twice", "a.ply", "ply\nformat ascii 1.0\nformat ascii 1.0\n", "a.ply:3", "twice"},
        BadMesh{"version", "a.ply", "ply\nformat ascii 2.0\n", "a.ply:2", "\"2.0\""},
        BadMesh{"long_format", "a.ply", "ply\nformat ascii 1.0 1.0\n", "a.ply:2", "4 words"},
        BadMesh{"element_twice", "a.ply", ply_start + "element vertex 3\n", "a.ply:7", "vertex twice"},
        BadMesh{"property_twice", "a.ply", ply_start + "property double x\n", "a.ply:7", "x twice"},
        BadMesh{"list_twice", "a.ply",
                ply_start + "element face 0\nproperty list uchar int vertex_index\n"
                            "property list uchar int vertex_indices\n",
                "a.ply:9", "twice"},
        BadMesh{"long_property", "a.ply", ply_start + "property float u v\n", "a.ply:7", "4 words"},
        BadMesh{"huge_count", "a.ply", announcing("element face 1000000000000000000\n" + corner_list),
                "a.ply", "end of the file"},
        BadMesh{"count_beyond_integers", "a.ply",
                announcing("element face 10000000000000000000\n" + corner_list), "a.ply:7",
                "10000000000000000000"},
        BadMesh{"one_too_many", "a.ply",
                announcing("element edge 1\nproperty int vertex1\nproperty int vertex2\n"), "a.ply",
                "end of the file"},
        BadMesh{"no_properties", "a.ply", announcing("element mystery 1000000000000000000\n"), "a.ply",
                "without a property"},
        BadMesh{"many_elements", "a.ply", announcing(many("element e", 1001, " 0\n")), "a.ply:1006",
                "one element more"},
        BadMesh{"many_properties", "a.ply", announcing("element e 0\n" + many("property char p", 1001, "\n")),
                "a.ply:1008", "one property more"},
        BadMesh{"data_behind", "a.ply", ply_start + ply_faces + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\n7\n",
                "a.ply:15", "behind the last element"},
        BadMesh{"far", "a.ply", ply_start + ply_faces + "0 0 0\n1 0 1e16\n0 1 0\n3 0 1 2\n", "a.ply:11",
                "1e+16"},
        BadMesh{"binary_behind", "a.ply", ply_binary + "\n", "a.ply", "1 bytes behind the last element"},
        BadMesh{"binary_empty_lists", "a.ply",
                "ply\nformat binary_little_endian 1.0\nelement face 1000000000000\n" + corner_list +
                    "end_header\n",
                "a.ply", "end of the file"},
        BadMesh{"binary_negative_list", "a.ply",
                with(replaced(ply_binary, "list uchar int", "list char int"), ply_first_face - 1,
                     std::int8_t{-1}),
                "a.ply: face 0", "a list of -1"},
        BadMesh{"binary_truncated", "a.ply", ply_binary.substr(0, ply_binary.size() - 1), "a.ply: face 3",
                "end of the file"},
        BadMesh{"binary_nan", "a.ply",
                with(ply_binary, ply_body + 25, std::numeric_limits<double>::quiet_NaN()), "a.ply: vertex 1",
                "nan"},
        BadMesh{"binary_index", "a.ply", with(ply_binary, ply_first_face + 13 + 1, std::int32_t{-1}),
                "a.ply: face 1", "vertex -1"}),
    [](const auto& one) { return one.param.label; });

const std::string stl_ascii = tetrahedron_stl_ascii();
const std::string stl_binary = tetrahedron_stl_binary();

INSTANTIATE_TEST_SUITE_P(
    stl, Malformed,
    ::testing::Values(
        BadMesh{"truncated", "a.stl", stl_ascii.substr(0, stl_ascii.size() - 40), "a.stl:27",
                "end of the file"},
        BadMesh{"word", "a.stl", "solid\nfacets\n", "a.stl:2", "\"facets\""},
        BadMesh{"outside", "a.stl", "solid\nvertex 0 0 0\n", "a.stl:2", "outside"},
        BadMesh{"behind_the_end", "a.stl", "solid\nendsolid\nfacet\n", "a.stl:3", "behind endsolid"},
        BadMesh{"four_numbers", "a.stl", "solid\nfacet\nvertex 0 0 0 0\n", "a.stl:3", "5 words"},
        BadMesh{"huge_count", "a.stl", with("x" + stl_binary.substr(1), 80, std::uint32_t{0xFFFFFFFF}),
                "a.stl", "284 bytes"},
        BadMesh{"two_vertices", "a.stl", "solid\nfacet\nvertex 0 0 0\nvertex 1 0 0\nendfacet\n", "a.stl:5",
                "2 vertices"},
        BadMesh{"not_solid", "a.stl", "solids are not what this is, and it is too short", "a.stl:1",
                "solids"},
        BadMesh{"binary_short", "a.stl", "binary", "a.stl", "6 bytes"},
        BadMesh{"binary_truncated", "a.stl", "x" + stl_binary.substr(1, stl_binary.size() - 3), "a.stl",
                "bytes"},
        BadMesh{"binary_nan", "a.stl",
                with(stl_binary, 84 + 50 + 12, std::numeric_limits<float>::quiet_NaN()), "a.stl: face 1",
                "nan"}),
    [](const auto& one) { return one.param.label; });

std::string msh(const std::string& elements) {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n7 0 1 "
         "0\n$EndNodes\n$Elements\n" +
         elements + "$EndElements\n";
}

INSTANTIATE_TEST_SUITE_P(
    msh, Malformed,
    ::testing::Values(
        BadMesh{"empty", "a.msh", "", "a.msh: \"\"", "no $MeshFormat"},
        BadMesh{"version", "a.msh", "$MeshFormat\n4 0 8\n", "a.msh: \"4 0 8\"", "version \"4\""},
        BadMesh{"size", "a.msh", "$MeshFormat\n2.2 0 4\n", "a.msh: \"2.2 0 4\"", "numbers of 4 bytes"},
        BadMesh{"no_node", "a.msh", msh("1\n4 2 0 1 2 3\n"), "a.msh: element 4", "node 3"},
        BadMesh{"second_order", "a.msh", msh("1\n4 9 0 1 2 7 1 2 7\n"), "a.msh: element 4",
                "triangle of second order (type 9)"},
        BadMesh{"unknown_type", "a.msh", msh("1\n4 99 0 1\n"), "a.msh: element 4", "an element of type 99"},
        BadMesh{"twice", "a.msh", msh("1\n4 2 0 1 2 2\n"), "a.msh: element 4", "node 2 twice"},
        BadMesh{
            "node_twice", "a.msh",
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n20\n1 0 0 0\n1 1 0 0\n                        ",
            "a.msh: node 1", "a node of that number already"},
        BadMesh{"huge_count", "a.msh", msh("1000000000000\n"), "a.msh: \"1000000000000\"",
                "\"$EndElements\""},
        BadMesh{"huge_nodes", "a.msh",
                "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1000000000000\n1 0 0 0\n",
                "a.msh: \"1000000000000\"", "1000000000000 things"}),
    [](const auto& one) { return one.param.label; });

const std::string vtk_start =
    "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 double\n0 0 0 1 0 0 0 1 0\n";
std::string vtu(const std::string& cells, const std::string& n = "1") {
  return "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"3\" NumberOfCells=\"" +
         n + "\"><Points>" + data_array("Float64", "Points", 3, "0 0 0 1 0 0 0 1 0") + "</Points><Cells>" +
         cells + "</Cells></Piece></UnstructuredGrid></VTKFile>";
}
std::string vtu_cells(const std::string& corners, const std::string& ends, const std::string& types) {
  return data_array("Int64", "connectivity", 1, corners) + data_array("Int64", "offsets", 1, ends) +
         data_array("UInt8", "types", 1, types);
}

INSTANTIATE_TEST_SUITE_P(
    vtk, Malformed,
    ::testing::Values(
        BadMesh{"empty", "a.vtk", "", "a.vtk: \"\"", "no first line"},
        BadMesh{"grid", "a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_GRID\n",
                "a.vtk: \"DATASET STRUCTURED_GRID\"", "STRUCTURED_GRID"},
        BadMesh{"cell_cut", "a.vtk", vtk_start + "CELLS 1 4\n4 0 1 2\n", "a.vtk: \"CELLS 1 4\"",
                "cell 0 of 4 corners"},
        BadMesh{"types_missing", "a.vtk", vtk_start + "CELLS 1 4\n3 0 1 2\n", "a.vtk", "1 cells and 0 types"},
        BadMesh{"hexahedron", "a.vtk", vtk_start + "CELLS 1 9\n8 0 1 2 0 1 2 0 1\nCELL_TYPES 1\n12\n",
                "a.vtk: cell 0", "a hexahedron (type 12)"},
        BadMesh{"word", "a.vtk", vtk_start + "NONSENSE 3\n", "a.vtk: \"NONSENSE 3\"", "\"NONSENSE\""},
        BadMesh{"huge", "a.vtk", vtk_start + "CELLS 1 1000000000\n", "a.vtk: \"CELLS 1 1000000000\"",
                "1000000000 things"},
        BadMesh{"xml_empty", "a.vtu", "", "a.vtu", "No document element"},
        BadMesh{"xml_other", "a.vtu", "<svg/>", "a.vtu", "no <VTKFile>"},
        BadMesh{"xml_image", "a.vtu", "<VTKFile type=\"ImageData\"/>", "a.vtu", "ImageData"},
        BadMesh{"xml_corner", "a.vtu", vtu(vtu_cells("0 1 3", "3", "5")), "a.vtu: cell 0", "vertex 3"},
        BadMesh{"xml_type", "a.vtu", vtu(vtu_cells("0 1 2", "3", "200")), "a.vtu: cell 0", "type 200"},
        BadMesh{"xml_quadratic", "a.vtu", vtu(vtu_cells("0 1 2 0 1 2", "6", "22")), "a.vtu: cell 0",
                "quadratic triangle (type 22)"},
        BadMesh{"xml_corners", "a.vtu", vtu(vtu_cells("0 1", "2", "5")), "a.vtu: cell 0",
                "a triangle (type 5) of 2 corners"},
        BadMesh{"xml_offset", "a.vtu", vtu(vtu_cells("0 1 2", "3 2", "5 5"), "2"),
                "a.vtu: <DataArray> \"connectivity\"", "3 numbers"},
        BadMesh{"xml_count", "a.vtu", vtu(vtu_cells("0 1 2", "3", "5"), "1000000000000"),
                "a.vtu: <DataArray> \"types\"", "1 numbers"},
        BadMesh{"xml_no_cells", "a.vtu", vtu(""), "a.vtu: <Cells> \"Piece\"", "no <DataArray> \"types\""},
        BadMesh{"xml_offset_beyond", "a.vtu",
                tetrahedron_vtu_appended().substr(0, tetrahedron_vtu_appended().find(">_") + 20),
                "a.vtu: <DataArray> \"Points\"", "end of its data"}),
    [](const auto& one) { return one.param.label; });

TEST(read_mesh, reports_several_violations_at_once) {
  try {
    parse_mesh(points + "f 1 2 9\nf 1 1 2\nf 1 2 3\nf 3 2 1\n", "a.obj");
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.violations().size(), 3u) << error.what();
  }
}

TEST(read_mesh, refuses_missing_files_and_unknown_extensions) {
  EXPECT_THROW(read_mesh("/no/such/file.obj"), ConfigError);
  EXPECT_THROW(read_mesh(BB_SOURCE_DIR), ConfigError);
  try {
    parse_mesh("", "mesh.step");
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.violations().front().found, "extension \".step\"");
    EXPECT_EQ(error.violations().front().allowed, "one of .obj, .ply, .stl, .msh, .vtk, .vtu, .vtp");
  }
}

}  // namespace
}  // namespace bb
