// Mesh generators that a config can name, with their parameter tables.
#pragma once

#include <string>
#include <vector>

#include "core/base/parameters/parameter.hpp"
#include "core/base/parameters/registry.hpp"
#include "core/model/mesh/triangle_mesh.hpp"

namespace bb {

struct MeshGenerator {
  std::string name, doc;
  std::vector<Parameter> parameters;
  TriangleMesh (*make)(const ParameterMap& complete) = nullptr;
};

const Registry<MeshGenerator>& mesh_generators();

}  // namespace bb
