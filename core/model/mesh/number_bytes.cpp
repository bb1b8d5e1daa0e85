#include "core/model/mesh/number_bytes.hpp"

namespace bb {
namespace {

template <class T>
double real_of(const char* at, bool big_endian) {
  return static_cast<double>(number_at<T>(at, big_endian));
}
template <class T>
long long integer_of_bytes(const char* at, bool big_endian) {
  return static_cast<long long>(number_at<T>(at, big_endian));
}
template <class T>
constexpr NumberType number_type(std::string_view xml, std::string_view legacy) {
  return {xml, legacy, sizeof(T), std::is_floating_point_v<T>, real_of<T>, integer_of_bytes<T>};
}

constexpr NumberType number_types[] = {
    number_type<float>("Float32", "float"),
    number_type<double>("Float64", "double"),
    number_type<std::int8_t>("Int8", "char"),
    number_type<std::int8_t>("", "signed_char"),
    number_type<std::int8_t>("", "vtktypeint8"),
    number_type<std::uint8_t>("UInt8", "unsigned_char"),
    number_type<std::uint8_t>("", "vtktypeuint8"),
    number_type<std::int16_t>("Int16", "short"),
    number_type<std::int16_t>("", "vtktypeint16"),
    number_type<std::uint16_t>("UInt16", "unsigned_short"),
    number_type<std::uint16_t>("", "vtktypeuint16"),
    number_type<std::int32_t>("Int32", "int"),
    number_type<std::int32_t>("", "vtkIdType"),
    number_type<std::int32_t>("", "vtktypeint32"),
    number_type<std::uint32_t>("UInt32", "unsigned_int"),
    number_type<std::uint32_t>("", "vtktypeuint32"),
    number_type<std::int64_t>("Int64", "long"),
    number_type<std::int64_t>("", "vtktypeint64"),
    number_type<std::uint64_t>("UInt64", "unsigned_long"),
    number_type<std::uint64_t>("", "vtktypeuint64"),
};

}  // namespace

const NumberType* number_type_of(std::string_view name) {
  if (name.empty()) return nullptr;
  const auto* found =
      std::find_if(std::begin(number_types), std::end(number_types),
                   [&](const NumberType& type) { return name == type.xml || name == type.legacy; });
  return found == std::end(number_types) ? nullptr : found;
}

}  // namespace bb
