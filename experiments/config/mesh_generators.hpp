// Mesh generators that a config can name, with their parameter tables.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"
#include "core/parameters/parameter.hpp"
#include "core/parameters/registry.hpp"

namespace bb {

struct MeshGenerator {
  std::string name, doc;
  std::vector<Parameter> parameters;
  TriangleMesh (*make)(const ParameterMap& complete) = nullptr;
};

const Registry<MeshGenerator>& mesh_generators();

}  // namespace bb
