// A part: a kind of element that a body can be made of, with all that the program has to know of it. A part is one file of parts/
// and one line and one header of core/model/scene/parts, which has its keys and columns as plain numbers.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/input/memory.hpp"
#include "core/energy/families/element_family.hpp"
#include "core/model/bodies/body_elements.hpp"
#include "core/model/bodies/body_spec.hpp"
#include "core/model/bodies/element_answer.hpp"
#include "core/model/bodies/material_settings.hpp"
#include "core/model/mesh/write_mesh.hpp"

namespace bb {

/// What a body has that can touch.
struct BodySurface {
  TriangleMesh mesh;           // triangles and lone edges; its vertices stay empty
  std::vector<char> enclosed;  // [n vertices of the body] not 0: on no surface, so it touches nothing
};

/// What a frame says beside positions.
struct FrameFields {
  std::vector<PlyColumn> of_vertices;   // a value a vertex of the scene
  std::vector<PlyColumn> of_triangles;  // a value a triangle of the collision surface
};

/// A `material` of a config whose keys have been read.
struct GivenMaterial {
  const nlohmann::json& object;
  bool complete;  // false: what was wrong has been removed, so that what is missing may have been given
};

class Part {
 public:
  Part() = default;
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
  virtual ~Part() = default;

  // --- what a body states of it
  /// Its keys in `material`, each with unit, range, default and meaning.
  virtual void add_keys(Settings<Material>& out) const = 0;
  /// A sentence about its keys together; empty: nothing to say.
  virtual std::string_view keys_doc() const { return {}; }
  /// Defaults that follow from other keys, and keys that exclude each other.
  virtual void settle(const GivenMaterial&, const Complaints&, Material&) const {}
  /// Checks that the ranges of its keys cannot express. The mesh has been checked. Complaints are at "/material/KEY".
  virtual void check(const BodySpec&, bool /*planar*/, const Complaints&) const {}

  /// What the mesh lacks for a key of this part to mean anything, as "the body has no triangle"; empty: nothing.
  virtual std::string_view lacks(const TriangleMesh&, std::string_view key) const = 0;

  // --- what a mesh brings, of deformable and of rigid bodies
  /// Primitives of the scene so far and of the mesh, of which this part says what they take.
  virtual std::vector<MemoryItem> memory(const Scene&, const TriangleMesh&) const { return {}; }
  /// Appends what of the mesh can touch.
  virtual void add_surface(const TriangleMesh&, BodySurface&) const {}

  // --- what a deformable body becomes in a scene
  virtual void add_masses(const BodySpec&, const AddMass&) const {}
  /// Appends the elements of a body to the part's columns; those all of whose vertices are prescribed are left out.
  virtual void add_elements(const BodySpec&, BodyElements&) const = 0;

  // --- its elements
  virtual std::size_t size(const Scene&) const = 0;
  /// "springs": what size() counts. "no spring": what is reported when there are none.
  virtual std::string_view elements() const = 0;
  virtual std::string_view no_elements() const = 0;
  /// One family a term of E; none without elements. The scene outlives them.
  virtual void add_families(const Scene&, const FamilyPlace&,
                            std::vector<std::unique_ptr<ElementFamily>>& out) const = 0;
  virtual void add_frame_fields(const Scene&, const Positions& /*x*/, FrameFields&) const {}

  // --- a single element, as `eval` requests it
  /// Names that are requested.
  virtual std::vector<std::string> element_names() const = 0;
  /// Reads every field, calls finish(), then computes. Errors: ConfigError of finish().
  virtual ElementAnswer element(const std::string& name, Fields& fields) const = 0;
};

/// A line of core/model/scene/parts/registry.inc.
struct PartEntry {
  std::string_view name, doc;
  const Part& part;
  bool has_kernels = false;  // whether its term is made on an executor
};

/// In the order of registry.inc.
std::span<const PartEntry> part_entries();

/// Errors: ConfigError at `where` when the scene has elements that no kernel is there for.
void require_kernels(std::span<const PartEntry> entries, const Scene& scene, const std::string& where);

namespace parts {
#define PART(name, ...)   \
  namespace name {        \
  const bb::Part& part(); \
  }
#include "core/model/scene/parts/registry.inc"
#undef PART
}  // namespace parts

}  // namespace bb
