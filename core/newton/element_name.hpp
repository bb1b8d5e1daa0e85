// Names of vertices and elements, for messages of a step that ended with NaN or infinite numbers.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/model/scene/scene.hpp"
#include "core/terms/host_term.hpp"

namespace bb {

/// BODY[number of the vertex in it].
std::string vertex_name(const Scene& scene, int vertex);
/// Of an element of a term: "element N of term NAME (its vertices)".
std::string element_name(const Scene& scene, std::string_view term, std::size_t element,
                         std::span<const int> vertices);
/// The first element of which an energy, a gradient or a Hessian is not finite, with its term and its vertices; empty
/// without one.
std::string broken_element_name(const Scene& scene, const TermList& terms);

}  // namespace bb
