// Numbers out of bytes of either order, of the types that mesh files name. Private to core/model/mesh.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace bb {

template <class T>
T number_at(const char* at, bool big_endian) {
  char raw[sizeof(T)];
  std::memcpy(raw, at, sizeof(T));
  if (big_endian != (std::endian::native == std::endian::big)) std::reverse(raw, raw + sizeof(T));
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

struct NumberType {
  std::string_view xml, legacy;  // names in files of VTK
  std::size_t size;
  bool is_real;
  double (*real)(const char* at, bool big_endian);
  long long (*integer)(const char* at, bool big_endian);
};

/// By one of its names; nullptr: there is none of that name.
const NumberType* number_type_of(std::string_view name);

}  // namespace bb
