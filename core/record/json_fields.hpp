// How values become JSON fields in every record of this project. Included by the writers only: it pulls in
// the JSON library.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/record/run_record.hpp"

namespace bb::fields {

using Json = nlohmann::ordered_json;

/// Sets j[name]; a missing value is null plus j["<name>_status"], the reason.
inline void put(Json& j, const std::string& name, const Number& n) {
  if (n.finite()) {
    j[name] = n.value;
  } else {
    j[name] = nullptr;
    j[name + "_status"] = n.status;
  }
}

Json phases(const PhaseTimes& times);   // "<phase>_s", phases that took no time left out
Json contacts(const ContactCounts& c);  // per kind and total
Json comparability(const Comparability& c);

/// Throws std::logic_error naming the place when a non-finite number is left in `j`: the JSON library would
/// silently write null without a reason.
void require_finite(const Json& j);

}  // namespace bb::fields
