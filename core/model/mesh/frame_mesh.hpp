// A mesh file as one frame of a trajectory that is judged: whatever positions it has, flat and repeated faces too.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "core/model/mesh/triangle_mesh.hpp"

namespace bb {

struct FrameField {
  std::string name;
  int components = 0;
  std::vector<double>
      values;  // [components n_vertices], vertex after vertex; empty when it was not requested
};

struct FrameMesh {
  Positions vertices = Positions(3, 0);       // [3 x n] in units of the file
  std::vector<int> corners;                   // of all polygons in a row, as they stand in the file
  std::vector<int> sizes;                     // how many corners each has
  std::vector<std::array<int, 3>> triangles;  // the polygons, cut
  std::vector<std::array<int, 2>> segments;
  std::vector<std::array<int, 4>> tetrahedra;
  std::vector<std::array<double, 2>> uvs;  // texture coordinates, where they were requested
  std::vector<int> corner_uvs;             // of every corner, into uvs; -1: none
  std::vector<FrameField> fields;          // of the vertices, as VTK files have them
  std::vector<std::string>
      notes;  // what was left out or could not be cut, counted, with the place of the first
};

/// Corners are judged (numbers of vertices, no one twice in a cell), positions are not: those of a frame may be anything.
/// Polygons are cut by the positions of this file; whoever has more frames keeps the cut of the first.
/// @param fields names of those whose values are wanted   @param uvs whether texture coordinates are, of an OBJ file
/// Errors: ConfigError with the file and the place of the first fault, as read_mesh; for cells that would be a surface and
/// are of no kind that is read, and for a wanted field that is not there.
FrameMesh parse_frame(const std::string& bytes, const std::string& name,
                      const std::set<std::string, std::less<>>& fields = {}, bool uvs = false);

}  // namespace bb
