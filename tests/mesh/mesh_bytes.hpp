// Mesh files in memory, for the tests of the readers: one tetrahedron in every format.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>

namespace bb::test {

template <class T>
void append(std::string& bytes, T value, bool big_endian) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (big_endian == (std::endian::native == std::endian::little)) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

inline constexpr double tetrahedron_points[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1.25}};
inline constexpr int tetrahedron_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

inline std::string tetrahedron_obj() {
  return "# comment\nmtllib none\nv 0 0 0\nv 1 0 0\nvn 0 0 1\nv 0 1 0\nv 0 0 1.25\n"
         "f 1 3 2\nf 1/1 2/2 4/3\nf 2//1 3//1 4//1\nf -4/1/1 -1/1/1 -2/1/1\n";
}

inline std::string ply_header(const std::string& format, const std::string& real, int n_vertices,
                              int n_faces) {
  return "ply\nformat " + format + " 1.0\ncomment made by a test\nelement vertex " +
         std::to_string(n_vertices) + "\nproperty " + real + " x\nproperty " + real + " y\nproperty " + real +
         " z\nproperty uchar red\n" + "element face " + std::to_string(n_faces) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

inline std::string tetrahedron_ply_ascii() {
  return ply_header("ascii", "float", 4, 4) +
         "0 0 0 7\n1 0 0 7\n0 1 0 7\n0 0 1.25 7\n3 0 2 1\n3 0 1 3\n\n3 1 2 3\n3 0 3 2\n";
}

template <class Real>
std::string tetrahedron_ply_binary(bool big_endian) {
  std::string bytes = ply_header(big_endian ? "binary_big_endian" : "binary_little_endian",
                                 sizeof(Real) == 4 ? "float" : "double", 4, 4);
  for (const auto& point : tetrahedron_points) {
    for (const double x : point) append(bytes, static_cast<Real>(x), big_endian);
    append(bytes, std::uint8_t{7}, big_endian);
  }
  for (const auto& face : tetrahedron_faces) {
    append(bytes, std::uint8_t{3}, big_endian);
    for (const int v : face) append(bytes, std::int32_t{v}, big_endian);
  }
  return bytes;
}

inline std::string tetrahedron_stl_ascii() {
  std::string text = "solid tetrahedron\n";
  for (const auto& face : tetrahedron_faces) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int v : face) {
      text += "vertex";
      for (const double x : tetrahedron_points[v]) text += " " + std::to_string(x == 0 ? -x : x);
      text += "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid tetrahedron\n";
}

inline std::string tetrahedron_stl_binary() {
  std::string bytes = "solid by name, binary by size";
  bytes.resize(80, ' ');
  append(bytes, std::uint32_t{4}, false);
  for (const auto& face : tetrahedron_faces) {
    for (int k = 0; k < 3; ++k) append(bytes, 0.0f, false);
    for (const int v : face) {
      for (const double x : tetrahedron_points[v]) append(bytes, static_cast<float>(x), false);
    }
    append(bytes, std::uint16_t{0}, false);
  }
  return bytes;
}

inline std::string tetrahedron_rows(const char* separator = "\n") {
  std::string text;
  for (const auto& point : tetrahedron_points) {
    for (const double x : point) text += std::to_string(x) + " ";
    text += separator;
  }
  return text;
}

/// The four faces with this before each, and node numbers from this one on.
inline std::string face_rows(const std::string& before, int first, const char* separator = "\n") {
  std::string text;
  for (const auto& face : tetrahedron_faces) {
    text += before;
    for (const int v : face) text += std::to_string(v + first) + " ";
    text += separator;
  }
  return text;
}

/// Nodes have the numbers 11 to 14.
inline std::string tetrahedron_msh_22() {
  std::string nodes, elements;
  for (int v = 0; v < 4; ++v) {
    nodes += std::to_string(11 + v);
    for (const double x : tetrahedron_points[v]) nodes += " " + std::to_string(x);
    nodes += "\n";
  }
  elements = face_rows("7 2 2 1 1 ", 11);
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n" + nodes + "$EndNodes\n$Elements\n4\n" +
         elements + "$EndElements\n";
}

inline std::string tetrahedron_msh_41() {
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"skin\"\n$EndPhysicalNames\n"
         "$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n" +
         tetrahedron_rows() + "$EndNodes\n$Elements\n1 4 1 4\n2 1 2 4\n" + face_rows("5 ", 1) +
         "$EndElements\n";
}

inline std::string tetrahedron_msh_22_binary() {
  std::string bytes = "$MeshFormat\n2.2 1 8\n";
  append(bytes, std::int32_t{1}, false);
  bytes += "\n$EndMeshFormat\n$Nodes\n4\n";
  for (int v = 0; v < 4; ++v) {
    append(bytes, std::int32_t{v + 1}, false);
    for (const double x : tetrahedron_points[v]) append(bytes, x, false);
  }
  bytes += "\n$EndNodes\n$Elements\n4\n";
  for (const int number : {2, 4, 1}) append(bytes, std::int32_t{number}, false);
  for (int f = 0; f < 4; ++f) {
    for (const int number : {f + 1, 0}) append(bytes, std::int32_t{number}, false);
    for (const int v : tetrahedron_faces[f]) append(bytes, std::int32_t{v + 1}, false);
  }
  return bytes + "\n$EndElements\n";
}

inline std::string tetrahedron_msh_41_binary() {
  std::string bytes = "$MeshFormat\n4.1 1 8\n";
  append(bytes, std::int32_t{1}, false);
  bytes += "\n$EndMeshFormat\n$Nodes\n";
  for (const int number : {1, 4, 1, 4}) append(bytes, std::int64_t{number}, false);
  for (const int number : {2, 1, 0}) append(bytes, std::int32_t{number}, false);
  for (const int number : {4, 1, 2, 3, 4}) append(bytes, std::int64_t{number}, false);
  for (const auto& point : tetrahedron_points) {
    for (const double x : point) append(bytes, x, false);
  }
  bytes += "\n$EndNodes\n$Elements\n";
  for (const int number : {1, 4, 1, 4}) append(bytes, std::int64_t{number}, false);
  for (const int number : {2, 1, 2}) append(bytes, std::int32_t{number}, false);
  append(bytes, std::int64_t{4}, false);
  for (int f = 0; f < 4; ++f) {
    append(bytes, std::int64_t{f + 1}, false);
    for (const int v : tetrahedron_faces[f]) append(bytes, std::int64_t{v + 1}, false);
  }
  return bytes + "\n$EndElements\n";
}

inline std::string tetrahedron_vtk_ascii() {
  return "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n" +
         tetrahedron_rows() + "CELLS 4 16\n" + face_rows("3 ", 0) +
         "CELL_TYPES 4\n5\n5\n5\n5\nCELL_DATA 4\nSCALARS mat int 1\nLOOKUP_TABLE default\n1 1 1 1\n"
         "POINT_DATA 4\nVECTORS u double\n0 0 0 0 0 0 0 0 0 1 2 3\nFIELD FieldData 1\nbody 1 4 int\n1 1 1 "
         "1\n";
}

/// Version 5.1: lists of offsets, a block of METADATA.
inline std::string tetrahedron_vtk_binary() {
  std::string bytes = "# vtk DataFile Version 5.1\ntitle\nBINARY\nDATASET POLYDATA\nPOINTS 4 float\n";
  for (const auto& point : tetrahedron_points) {
    for (const double x : point) append(bytes, static_cast<float>(x), true);
  }
  bytes += "\nMETADATA\nINFORMATION 0\n\nPOLYGONS 5 12\nOFFSETS vtktypeint64\n";
  for (int k = 0; k < 5; ++k) append(bytes, std::int64_t{3 * k}, true);
  bytes += "\nCONNECTIVITY vtktypeint64\n";
  for (const auto& face : tetrahedron_faces) {
    for (const int v : face) append(bytes, std::int64_t{v}, true);
  }
  return bytes + "\n";
}

inline std::string data_array(const std::string& type, const std::string& name, int components,
                              const std::string& numbers) {
  return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
         std::to_string(components) + "\" format=\"ascii\">" + numbers + "</DataArray>";
}

/// With the displacement u of the last vertex.
inline std::string tetrahedron_vtu_ascii() {
  return "<?xml version=\"1.0\"?><VTKFile type=\"UnstructuredGrid\" "
         "byte_order=\"LittleEndian\"><UnstructuredGrid>"
         "<Piece NumberOfPoints=\"4\" NumberOfCells=\"4\"><PointData>" +
         data_array("Float64", "u", 3, "0 0 0 0 0 0 0 0 0 1 2 3") + "</PointData><Points>" +
         data_array("Float64", "Points", 3, tetrahedron_rows(" ")) + "</Points><Cells>" +
         data_array("Int64", "connectivity", 1, face_rows("", 0, " ")) +
         data_array("Int64", "offsets", 1, "3 6 9 12") + data_array("UInt8", "types", 1, "5 5 5 5") +
         "</Cells></Piece></UnstructuredGrid></VTKFile>";
}

/// Raw bytes behind the XML, with lengths of 64 bits.
inline std::string tetrahedron_vtu_appended() {
  std::string data;
  const auto array = [&](const std::string& type, const std::string& name, const std::string& bytes) {
    const std::string offset = std::to_string(data.size());
    append(data, std::uint64_t{bytes.size()}, false);
    data += bytes;
    return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" format=\"appended\" offset=\"" + offset +
           "\"/>";
  };
  std::string points, corners, ends, types;
  for (const auto& point : tetrahedron_points) {
    for (const double x : point) append(points, x, false);
  }
  for (int f = 0; f < 4; ++f) {
    for (const int v : tetrahedron_faces[f]) append(corners, std::int32_t{v}, false);
    append(ends, std::int32_t{3 * f + 3}, false);
    append(types, std::uint8_t{5}, false);
  }
  const std::string of_points =
      array("Float64", "Points", points);  // first: offsets follow the order of the calls
  const std::string of_corners = array("Int32", "connectivity", corners);
  const std::string of_ends = array("Int32", "offsets", ends);
  const std::string of_types = array("UInt8", "types", types);
  return "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" "
         "header_type=\"UInt64\"><UnstructuredGrid>"
         "<Piece NumberOfPoints=\"4\" NumberOfCells=\"4\"><Points>" +
         of_points + "</Points><Cells>" + of_corners + of_ends + of_types +
         "</Cells></Piece></UnstructuredGrid><AppendedData encoding=\"raw\">_" + data +
         "</AppendedData></VTKFile>";
}

inline std::string tetrahedron_vtp_ascii() {
  return "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\"><PolyData><Piece NumberOfPoints=\"4\" "
         "NumberOfPolys=\"4\">"
         "<Points>" +
         data_array("Float32", "Points", 3, tetrahedron_rows(" ")) + "</Points><Polys>" +
         data_array("Int64", "connectivity", 1, face_rows("", 0, " ")) +
         data_array("Int64", "offsets", 1, "3 6 9 12") + "</Polys></Piece></PolyData></VTKFile>";
}

}  // namespace bb::test
