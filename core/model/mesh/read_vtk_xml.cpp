// VTK's XML files of one mesh: VTU (unstructured grid) and VTP (polygons). All pieces of a file, one after the other.
#include <fmt/format.h>

#include "core/math/error.hpp"
#include "core/model/mesh/vtk_cells.hpp"
#include "core/model/mesh/vtk_xml.hpp"

namespace bb {
namespace {

/// The <DataArray> of this name. Errors: ConfigError where there is none.
pugi::xml_node array_named(const VtkXml& xml, pugi::xml_node parent, const char* name) {
  const pugi::xml_node found = parent.find_child_by_attribute("DataArray", "Name", name);
  if (!found)
    xml.fail(parent, fmt::format("no <DataArray> \"{}\"", name), "Points and cells in each <Piece>");
  return found;
}

class XmlMesh {
 public:
  XmlMesh(const std::string& bytes, const std::string& name, const FieldNames& wanted)
      : xml_(bytes, name), fields_(wanted) {
    mesh_.name = name;
    mesh_.places_are_lines = false;
    mesh_.cell_element = "cell";
  }

  RawMesh run() {
    const std::string type = xml_.type();
    if (type != "UnstructuredGrid" && type != "PolyData") {
      throw ConfigError(mesh_.name, fmt::format("<VTKFile type=\"{}\">", type),
                        "UnstructuredGrid (vtu), PolyData (vtp)");
    }
    for (const pugi::xml_node piece : xml_.root().child(type.c_str()).children("Piece")) {
      base_ = static_cast<long long>(mesh_.vertices.size());
      take_points(piece);
      type == "PolyData" ? take_polygons(piece) : take_cells(piece);
      take_fields(piece);
    }
    return std::move(mesh_);
  }

 private:
  void take_points(pugi::xml_node piece) {
    n_points_ = xml_.count_of(piece, "NumberOfPoints", 0);
    if (n_points_ == 0) return;
    const pugi::xml_node array = piece.child("Points").child("DataArray");
    if (!array)
      xml_.fail(piece, fmt::format("{} points without <Points>", n_points_), "<Points> with a <DataArray>");
    if (xml_.count_of(array, "NumberOfComponents", 3) != 3)
      xml_.fail(array, "points without 3 components", "3");
    const std::vector<double> x = xml_.reals(array, 3 * n_points_);
    for (std::size_t i = 0; i + 2 < x.size(); i += 3) {
      mesh_.add_vertex({x[i], x[i + 1], x[i + 2]}, static_cast<long long>(mesh_.vertices.size()));
    }
  }

  void take_cells(pugi::xml_node piece) {
    const long long n = xml_.count_of(piece, "NumberOfCells", 0);
    if (n == 0) return;
    const pugi::xml_node cells = piece.child("Cells");
    take(cells, xml_.integers(array_named(xml_, cells, "types"), n));
  }

  void take_polygons(pugi::xml_node piece) {
    constexpr std::pair<const char*, long long> kinds[] = {
        {"Verts", 2}, {"Lines", 4}, {"Strips", 6}, {"Polys", 7}};
    for (const auto& [name, type] : kinds) {
      const long long n = xml_.count_of(piece, fmt::format("NumberOf{}", name).c_str(), 0);
      if (n > 0) take(piece.child(name), types_of(piece.child(name), n, type));
    }
  }

  std::vector<long long> types_of(pugi::xml_node cells, long long n, long long type) {
    const std::vector<long long> ends = xml_.integers(array_named(xml_, cells, "offsets"), n);
    return std::vector<long long>(ends.size(), type);
  }

  void take(pugi::xml_node cells, const std::vector<long long>& types) {
    const auto n = static_cast<long long>(types.size());
    const std::vector<long long> ends = xml_.integers(array_named(xml_, cells, "offsets"), n);
    const pugi::xml_node corners = array_named(xml_, cells, "connectivity");
    if (ends.back() < 0) xml_.fail(cells, fmt::format("the last offset {}", ends.back()), "offsets >= 0");
    add_vtk_cells(mesh_, xml_.integers(corners, ends.back()), ends, types, base_, cells_);
    cells_ += n;
  }

  void take_fields(pugi::xml_node piece) {
    for (const pugi::xml_node array : piece.child("PointData").children("DataArray")) {
      const std::string name = array.attribute("Name").value(), type = array.attribute("type").value();
      if (type != "Float32" && type != "Float64") continue;
      const long long components = xml_.count_of(array, "NumberOfComponents", 1);
      if (components < 1 || components > 3) continue;
      std::vector<double> values;
      if (fields_.is_wanted(name)) values = xml_.reals(array, components * n_points_);
      fields_.add(mesh_, name, components, std::move(values), static_cast<std::size_t>(n_points_));
    }
  }

  VtkXml xml_;
  VtkFields fields_;
  RawMesh mesh_;
  long long base_ = 0, n_points_ = 0, cells_ = 0;
};

}  // namespace

RawMesh parse_vtk_xml(const std::string& bytes, const std::string& name, const FieldNames& wanted) {
  return XmlMesh(bytes, name, wanted).run();
}

}  // namespace bb
