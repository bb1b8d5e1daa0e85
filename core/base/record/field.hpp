// Fields of records. A struct declares each of its members with one BB_FIELD; JSON (write_json.cpp,
// read_json.cpp), JSON Schema and data dictionary (schema.hpp) are made from these lines.
#pragma once

#include <type_traits>
#include <utility>

namespace bb {

/// What a field says of itself. The end of its name is its unit (unit_of in schema.hpp).
struct FieldText {
  const char* name;
  const char* doc;
  /// Of a Number: the words that say why there is none, with blanks between; each may also be one of
  /// absent_words. Of a string: the words that it may be, or a pattern that begins with '^'; "": any text. Of
  /// an integer: its minimum, 0 without.
  const char* allowed = "";
};

/// Why a double of any field may be null, and a Number of any field.
inline constexpr const char* non_finite_words = "nan infinite minus_infinite";
inline constexpr const char* absent_words = "not_measured nan infinite minus_infinite";

template <int>
struct FieldLine {};

/// Before what is made of one field: its code stands once for a type and not once for each of almost 400 fields.
#define BB_ONCE_A_TYPE [[gnu::noinline]]

/// First in a record struct, BB_RECORD_END last: the fields between them are its list. A struct with the
/// fields of another one derives from it and names it as BaseRecord.
#define BB_RECORD(Type, text)                       \
  using Self = Type;                                \
  static constexpr const char* record_name = #Type; \
  static constexpr const char* record_doc = text;   \
  static constexpr int first_line = __LINE__
#define BB_RECORD_END static constexpr int last_line = __LINE__

/// BB_FIELD(type, name, doc [, allowed]) [= initial value]: a member; its name is that of the JSON field.
#define BB_FIELD(Type, name, ...)                                 \
  static constexpr auto field(FieldLine<__LINE__>) {              \
    return std::pair{FieldText{#name, __VA_ARGS__}, &Self::name}; \
  }                                                               \
  Type name
/// BB_DERIVED(type, name, doc) { body }: a field that is computed, and written but not read.
#define BB_DERIVED(Type, name, ...)                               \
  static constexpr auto field(FieldLine<__LINE__>) {              \
    return std::pair{FieldText{#name, __VA_ARGS__}, &Self::name}; \
  }                                                               \
  Type name() const

/// BB_FIELDS_OF(Base): the fields of a record that this one derives from, in this place. Base says with BB_RECORD_LIST that its
/// fields are lines of another file, which is included behind it.
template <class Base>
struct FieldsOf {};
#define BB_FIELDS_OF(Base) \
  static constexpr auto field(FieldLine<__LINE__>) { return FieldsOf<Base>{}; }
#define BB_RECORD_LIST(Type, text)                  \
  using Self = Type;                                \
  static constexpr const char* record_name = #Type; \
  static constexpr const char* record_doc = text;   \
  static constexpr int first_line = 0, last_line = 100

template <class T>
concept Record = requires {
  T::record_name;
};

template <Record T, class Visitor>
void for_each_field(Visitor&& visitor);

template <class Base, class Visitor>
void visit_field(FieldsOf<Base>, Visitor& visitor) {
  for_each_field<Base>(visitor);
}
template <class Member, class Visitor>
void visit_field(const std::pair<FieldText, Member>& field, Visitor& visitor) {
  visitor(field.first, field.second);
}
template <class T, int Line, class Visitor>
void visit_line(Visitor& visitor) {
  if constexpr (requires { T::field(FieldLine<Line>{}); }) {
    constexpr auto field = T::field(FieldLine<Line>{});
    visit_field(field, visitor);
  }
}

/// visitor(FieldText, pointer to member) for every field of T in order, those of its BaseRecord last.
template <Record T, class Visitor>
void for_each_field(Visitor&& visitor) {
  [&]<int... I>(std::integer_sequence<int, I...>) { (visit_line<T, T::first_line + 1 + I>(visitor), ...); }
  (std::make_integer_sequence<int, T::last_line - T::first_line>{});
  if constexpr (requires { typename T::BaseRecord; }) for_each_field<typename T::BaseRecord>(visitor);
}

/// Number of enumerators, from 0, of an enum that a record writes as a word; to_string(E) gives the word.
template <class E>
inline constexpr int n_words = 0;

}  // namespace bb
