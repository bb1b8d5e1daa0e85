#include "experiments/run/run_limits.hpp"

#include <fmt/format.h>

#include "core/base/record/phase_times.hpp"

namespace bb {

void RunLimits::look_up(const std::string& part, const std::string& place) const {
  if (interrupted && interrupted->load()) throw Interrupted{};
  if (!(deadline_s > 0) || now_s() < deadline_s) return;
  throw TimeOver{fmt::format("{}: the time limit of {:g} s was reached {}; there was no first step", part,
                             time_limit_s, place)};
}

}  // namespace bb
