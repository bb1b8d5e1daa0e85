// Shapes that differ in an exponent and share a name: NAME:A is the member with exponent A.
#pragma once

#include <string_view>

#include "core/barrier/shape.hpp"

namespace bb {

struct ShapeFamily {
  std::string_view name;
  double least, most, usual;  // exponents that are allowed, and that of the plain name
  /// The shape with another exponent, under the name it was requested by.
  Shape (*member)(Shape plain, std::string_view name, double exponent);
};

}  // namespace bb
