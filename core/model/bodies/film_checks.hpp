// What a film of a body has to be.
#pragma once

#include <span>
#include <string>

#include "core/model/bodies/body_spec.hpp"
#include "core/model/bodies/complaints.hpp"

namespace bb {

/// Of a motion with a film: of as many vertices as the body has, in the plane of a planar scene, within the bounds of coordinates.
void check_film(const Complaints& report, const std::string& what, const PrescribedMotion& motion,
                const BodySpec& spec, bool planar);
/// At the time 0 these vertices of the body are where they start, to 1e-6 of its size and place.
void check_film_start(const Complaints& report, const std::string& what, const PrescribedMotion& motion,
                      const Positions& start, std::span<const int> vertices);

/// Of a rest film: the same numbers, every element of every frame with an area or a volume, and no strain limit.
void check_rest_film(const Complaints& report, const BodySpec& spec, bool planar);

}  // namespace bb
