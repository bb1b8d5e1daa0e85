// What makes the families of elements of a scene. Their columns outlive them. rest: what moves their rest shapes from step to step. Errors of all: ConfigError for a column of another
// length; OutOfMemory.
#pragma once

#include "core/energy/families/element_family.hpp"
#include "core/math/types.hpp"
#include "core/model/scene/moving_rest.hpp"

namespace bb {

using MadeFamily = std::unique_ptr<ElementFamily>;

/// @param x_rest  [3 x n_vertices] m   @param planar  F is 2 x 2 in the x-y plane, z has no terms
/// Errors: ConfigError for an unknown model, triangles without area, or a warp direction that is normal to one.
MadeFamily membrane_family(const FamilyPlace& place, const MembranePart& part, const PositionsView& x_rest,
                           bool planar, MovingRest rest = {});

/// Names of the buffers of a family of springs.
struct SpringNames {
  const char *vertices = "spring vertices", *stiffness = "spring stiffness",
             *rest_length = "spring rest lengths";
};
/// stiffness [n] N/m, rest_length [n] m.
MadeFamily spring_family(const FamilyPlace& place, const SpringNames& names,
                         std::span<const std::array<int, 2>> pairs, std::span<const double> stiffness,
                         std::vector<double> rest_length, MovingRest rest = {});
/// Distances [n] (m) of pairs of vertices at x.
std::vector<double> lengths_of(std::span<const std::array<int, 2>> pairs, const PositionsView& x);

/// The springs that stitch vertices together.
MadeFamily stitch_family(const FamilyPlace& place, const Stitches& stitches);

/// Loads of a scene, which outlives them.
MadeFamily inertia_family(const FamilyPlace& place, const Scene& scene);
MadeFamily weight_family(const FamilyPlace& place, const Scene& scene);
MadeFamily pull_family(const FamilyPlace& place, const Scene& scene);
MadeFamily air_drag_family(const FamilyPlace& place, const Scene& scene);
MadeFamily inflation_family(const FamilyPlace& place, const Scene& scene);

MadeFamily cloth_spring_family(const FamilyPlace& place, const ClothSpringPart& part, MovingRest rest = {});
MadeFamily hinge_family(const FamilyPlace& place, const HingePart& part, MovingRest rest = {});
MadeFamily rod_family(const FamilyPlace& place, const RodPart& part, MovingRest rest = {});
/// Errors: ConfigError for an unknown model, or a rest tetrahedron whose volume is not positive.
MadeFamily tetrahedron_family(const FamilyPlace& place, const SolidPart& part, const PositionsView& x_rest,
                              MovingRest rest = {});

}  // namespace bb
