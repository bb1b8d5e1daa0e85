// The plain numbers of all parts together: what a material states, and what a scene has.
#pragma once

#include <array>
#include <vector>

#include "core/model/scene/part_list.hpp"

namespace bb::parts {

template <class... Each>
struct AllOf : Each... {};

struct NoKeys {};
struct NoColumns {};

/// A struct with the members of the Keys of every part, and one with those of the Columns.
#define PART(name, ...) name::Keys,
using AllKeys = AllOf<
#include "core/model/scene/parts/registry.inc"
    NoKeys>;
#undef PART
#define PART(name, ...) name::Columns,
using AllColumns = AllOf<
#include "core/model/scene/parts/registry.inc"
    NoColumns>;
#undef PART

/// f(columns) of every part, in the order of registry.inc.
template <class F, class... Each>
void for_each_columns(const AllOf<Each...>& all, const F& f) {
  (f(static_cast<const Each&>(all)), ...);
}

/// Triangles of the elements that fill an area: those of every Columns with filled_triangles().
inline std::vector<std::array<int, 3>> filled_triangles(const AllColumns& all) {
  std::vector<std::array<int, 3>> out;
  for_each_columns(all, [&out](const auto& columns) {
    if constexpr (requires { columns.filled_triangles(); }) {
      const auto& more = columns.filled_triangles();
      out.insert(out.end(), more.begin(), more.end());
    }
  });
  return out;
}

/// Edges that elements join the ends of: those of every Columns with joined_edges().
inline std::vector<std::array<int, 2>> joined_edges(const AllColumns& all) {
  std::vector<std::array<int, 2>> out;
  for_each_columns(all, [&out](const auto& columns) {
    if constexpr (requires { columns.joined_edges(); }) {
      const auto& more = columns.joined_edges();
      out.insert(out.end(), more.begin(), more.end());
    }
  });
  return out;
}

}  // namespace bb::parts
