// What bodies, obstacles and finished scenes must satisfy. Each check appends what it finds, none throws.
// Private to core/model/bodies.
#pragma once

#include <string>
#include <vector>

#include "core/math/error.hpp"
#include "core/model/bodies/body_spec.hpp"

namespace bb {

void check_body(const BodySpec& spec, bool planar, const std::string& where, std::vector<Violation>& out);
void check_obstacle(const Obstacle& obstacle, bool planar, const std::string& where,
                    std::vector<Violation>& out);
/// pin_of: [n_vertices] -1 where free, at some time at least.
void check_scene(const Scene& scene, const std::vector<int>& pin_of, const std::string& where,
                 std::vector<Violation>& out);

}  // namespace bb
