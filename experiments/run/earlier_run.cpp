#include "experiments/run/earlier_run.hpp"

#include <fmt/format.h>

#include "core/math/error.hpp"
#include "experiments/run/stored_run.hpp"

namespace bb {
namespace {

ConfigError refusal(const std::filesystem::path& file, const std::string& found) {
  return {file.string(), found,
          "another folder, or one with a record of this very config; --replace (in Python replace=True) "
          "lets the record go with its files"};
}

}  // namespace

void require_replaceable(const std::filesystem::path& folder, const RunRecord& now, bool replace,
                         const std::function<void(const std::string&)>& tell) {
  const std::filesystem::path file = folder / "run.json";
  std::error_code unreachable;
  if (replace || !std::filesystem::exists(file, unreachable)) return;
  if (std::filesystem::is_directory(file, unreachable)) return;  // check_writable says that it is in the way
  std::optional<StoredRun> earlier;
  try {
    earlier = read_stored_run(file);
  } catch (const ConfigError& error) {
    throw refusal(file, fmt::format("a file that is no record of this version ({})", error.what()));
  }
  if (!earlier) throw refusal(file, "a file that is no record of a run");
  const RunRecord& then = earlier->record;
  if (then.ids.config_id != now.ids.config_id) {
    throw refusal(
        file, fmt::format("the record of another run, \"{}\" (config_id {}, and of this run {})",
                          then.labels.note, then.ids.config_id.substr(0, 8), now.ids.config_id.substr(0, 8)));
  }
  std::string others;
  for (const Difference& difference : differences(then, now))
    others += (others.empty() ? "" : "; ") + difference.what;
  if (!others.empty() && tell)
    tell(fmt::format("{} is replaced when this run is over; it was made by {}", file.string(), others));
}

}  // namespace bb
