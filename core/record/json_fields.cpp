// Fields shared by the run record and the trace.
#include "core/record/json_fields.hpp"

#include <cmath>
#include <stdexcept>

namespace bb::fields {

Json phases(const PhaseTimes& times) {
  Json j = Json::object();
  for (std::size_t i = 0; i < kPhases; ++i) {
    if (times.s[i] != 0) put(j, std::string(kPhaseNames[i]) + "_s", times.s[i]);
  }
  return j;
}

Json contacts(const ContactCounts& c) {
  return {{"point_point", c.point_point},
          {"point_edge", c.point_edge},
          {"point_triangle", c.point_triangle},
          {"edge_edge", c.edge_edge},
          {"obstacle", c.obstacle},
          {"mollified", c.mollified},
          {"total", c.total()}};
}

void require_finite(const Json& j) {
  if (j.is_number_float() && !std::isfinite(j.get<double>())) {
    throw std::logic_error("record: a non-finite number without a status");
  }
  if (j.is_structured()) {
    for (const Json& child : j) require_finite(child);
  }
}

}  // namespace bb::fields
