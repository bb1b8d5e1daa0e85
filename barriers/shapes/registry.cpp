// The list of shapes, filled once from registry.inc.
#include "barriers/shapes/registry.hpp"

#include <utility>

#include "barriers/named_entries.hpp"

namespace bb {

#define ENTRY(name, doc) Shape make_shape_##name(const char*, const char*);
#include "barriers/shapes/registry.inc"
#undef ENTRY

namespace {

std::vector<Shape>& mutable_shapes() {
#define ENTRY(name, doc) make_shape_##name(#name, doc),
  static std::vector<Shape> list{
#include "barriers/shapes/registry.inc"
  };
#undef ENTRY
  return list;
}

}  // namespace

const std::vector<Shape>& shapes() { return mutable_shapes(); }
const Shape* find_shape(std::string_view name) { return find_entry(shapes(), name); }
const Shape& require_shape(std::string_view name, std::string_view where) {
  return require_entry(shapes(), name, where);
}
void register_shape(Shape shape, std::string_view where) {
  append_entry(mutable_shapes(), std::move(shape), where);
}

Argument require_argument(std::string_view name, std::string_view where) {
  for (const Argument argument : {Argument::gap, Argument::squared_gap}) {
    if (name == to_string(argument)) return argument;
  }
  throw unknown_name(where, name,
                     {std::string(to_string(Argument::gap)), std::string(to_string(Argument::squared_gap))});
}

}  // namespace bb
