// The list of shapes, filled once from registry.inc.
#include "barriers/shapes/registry.hpp"

#include <fmt/format.h>

#include <charconv>

#include "barriers/formulas.hpp"
#include "barriers/shapes/shape_family.hpp"
#include "core/barrier/folded_barrier.hpp"

namespace bb {

#define ENTRY(name, doc)                             \
  Shape make_shape_##name(const char*, const char*); \
  const ShapeFamily* shape_family_##name();
#include "barriers/shapes/registry.inc"
#undef ENTRY

Registry<Shape>& all_shapes() {
#define ENTRY(name, doc) make_shape_##name(#name, doc),
  static Registry<Shape> all({
#include "barriers/shapes/registry.inc"
  });
#undef ENTRY
  return all;
}

namespace {

/// The shapes that have an exponent.
const std::vector<const ShapeFamily*>& families() {
  static const std::vector<const ShapeFamily*> all = [] {
    std::vector<const ShapeFamily*> found;
#define ENTRY(name, doc) found.push_back(shape_family_##name());
#include "barriers/shapes/registry.inc"
#undef ENTRY
    std::erase(found, nullptr);
    return found;
  }();
  return all;
}

/// Nothing unless all of the text is a number.
std::optional<double> number_in_text(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::vector<std::string> shape_names() {
  std::vector<std::string> names = all_shapes().names();
  names.push_back(std::string(formula_prefix) + "TEXT");
  for (const ShapeFamily* family : families()) names.push_back(std::string(family->name) + ":A");
  return names;
}

Shape require_shape(std::string_view name, std::string_view where) {
  if (const Shape* shape = all_shapes().find(name)) return *shape;
  if (is_formula(name)) return require_formula(name.substr(formula_prefix.size()), {}, where).shape;
  for (const ShapeFamily* family : families()) {
    const std::size_t colon = family->name.size();
    if (!name.starts_with(family->name) || name.size() == colon || name[colon] != ':') continue;
    const std::optional<double> a = number_in_text(name.substr(colon + 1));
    if (a && *a >= family->least && *a <= family->most) {
      return family->member(all_shapes().require(family->name, where), name, *a);
    }
    throw ConfigError(std::string(where), fmt::format("\"{}\"", name),
                      fmt::format("{}:A with an exponent A from {:g} to {:g}, {:g} without one", family->name,
                                  family->least, family->most, family->usual));
  }
  throw unknown_name(where, name, shape_names());
}

std::optional<Shape> find_shape(std::string_view name) {
  try {
    return require_shape(name);
  } catch (const ConfigError&) {
    return std::nullopt;
  }
}

std::string shapes_with_potential() {
  std::string names;
  for (const Shape& shape : all_shapes()) {
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
