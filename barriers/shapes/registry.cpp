// The list of shapes, filled once from registry.inc.
#include "barriers/shapes/registry.hpp"

#include "core/barrier/folded_barrier.hpp"

namespace bb {

#define ENTRY(name, doc) Shape make_shape_##name(const char*, const char*);
#include "barriers/shapes/registry.inc"
#undef ENTRY

Registry<Shape>& shapes() {
#define ENTRY(name, doc) make_shape_##name(#name, doc),
  static Registry<Shape> all({
#include "barriers/shapes/registry.inc"
  });
#undef ENTRY
  return all;
}

const Shape& require_shape(std::string_view name, std::string_view where) {
  return shapes().require(name, where);
}

std::string shapes_with_potential() {
  std::string names;
  for (const Shape& shape : shapes()) {
    if (has_potential({shape, Argument::gap})) names += (names.empty() ? "" : ", ") + shape.name;
  }
  return names;
}

Argument require_argument(std::string_view name, std::string_view where) {
  for (const Argument argument : {Argument::gap, Argument::squared_gap}) {
    if (name == to_string(argument)) return argument;
  }
  throw unknown_name(where, name,
                     {std::string(to_string(Argument::gap)), std::string(to_string(Argument::squared_gap))});
}

}  // namespace bb
