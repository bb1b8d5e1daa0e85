// Cells of VTK by their numbers, alike in legacy files and in XML. Private to core/model/mesh.
#pragma once

#include <span>

#include "core/model/mesh/raw_mesh.hpp"

namespace bb {

/// Adds a cell of a type of VTK. Errors: ConfigError with its place for a type that is no point, line, strip, polygon or
/// tetrahedron of first order, and for a wrong number of corners.
void add_vtk_cell(RawMesh& mesh, long long type, std::span<const long long> corners, long long place);

/// The same cells of a file with lists of offsets and types. Errors: ConfigError, offsets that do not increase too.
/// @param base added to every corner   @param first place of the first cell
void add_vtk_cells(RawMesh& mesh, const std::vector<long long>& corners, const std::vector<long long>& ends,
                   const std::vector<long long>& types, long long base, long long first);

/// The fields of a part of the file; a wanted one has to be in each part. Errors: ConfigError.
/// @param n vertices of the part, the last ones of the mesh
class VtkFields {
 public:
  explicit VtkFields(const FieldNames& wanted) : wanted_(wanted) {}
  bool is_wanted(const std::string& name) const { return wanted_.contains(name); }
  /// values: empty when the field is not wanted.
  void add(RawMesh& mesh, const std::string& name, long long components, std::vector<double> values,
           std::size_t n) const;

 private:
  const FieldNames& wanted_;
};

}  // namespace bb
