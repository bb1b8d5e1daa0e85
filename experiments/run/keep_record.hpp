// Parts of a record in an archive (core/base/archive), by their lists of fields: every bit of them, and the reason where
// a number is absent.
#pragma once

#include "core/base/archive/archive.hpp"
#include "core/base/record/run_record.hpp"

namespace bb {

void keep(Archive& archive, Number& number);
void keep(Archive& archive, PhaseTimes& times);
void keep(Archive& archive, JsonText& text);
void keep(Archive& archive, SolverCounts& counts);

template <Record T>
void keep(Archive& archive, T& record) {
  for_each_field<T>([&](const FieldText&, auto member) {
    if constexpr (std::is_member_object_pointer_v<decltype(member)>) archive(record.*member);
  });
}

}  // namespace bb
