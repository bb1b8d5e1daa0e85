#include "experiments/run/earlier_run.hpp"

#include <fmt/format.h>

#include <cctype>
#include <nlohmann/json.hpp>

#include "core/base/input/names.hpp"
#include "core/base/input/read_file.hpp"
#include "core/base/record/places.hpp"
#include "core/math/error.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/checkpoint.hpp"
#include "experiments/run/input_files.hpp"
#include "experiments/run/stored_run.hpp"

namespace bb {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

ConfigError refusal(const fs::path& file, const std::string& found, Replace replace) {
  return {file.string(), found,
          replace == Replace::torn
              ? "another folder of the sweep (--out), or one in which this file is not there"
              : "another folder, or one with a run of this very config; --replace (in Python replace=True) "
                "lets what is there go, with the files of a record"};
}

/// What two configs are compared by: neither where files lie nor the number of threads makes another run.
json compared(json config) {
  config.erase("threads");
  return without_places(std::move(config));
}

/// The config of an earlier run as this program resolves it, which may have settings that an earlier program did not have; as
/// it was stored, where this program refuses it.
json resolved_now(const std::string& stored, const fs::path& folder) {
  try {
    const RunConfig config = parse_config(stored, "the stored config", folder.string());
    return compared(resolved_document(name_from(folder, config)));
  } catch (const ConfigError&) {
    return compared(json::parse(stored));
  }
}

std::string value_at(const json& config, const json::json_pointer& place) {
  return config.contains(place) ? shortened(config.at(place).dump()) : "not set";
}

/// The first setting that differs, with both values; empty: the two configs are of the same run.
std::string difference_of(const std::string& stored, const std::string& now, const fs::path& folder) {
  const json asked = compared(json::parse(now));
  if (compared(json::parse(stored)) == asked) return {};
  const json then = resolved_now(stored, folder), changes = json::diff(then, asked);
  if (changes.empty()) return {};
  const json::json_pointer place(changes.front().at("path").get<std::string>());
  return fmt::format("{} is {} there and {} in this run{}", place.to_string(), value_at(then, place),
                     value_at(asked, place),
                     changes.size() > 1 ? fmt::format("; {} differences in all", changes.size()) : "");
}

/// difference_of, with the config of this run for which it is empty, or else the first.
std::string difference_of(const std::string& stored, const AskedRun& asked) {
  const std::string out = difference_of(stored, asked.now.config.text, asked.folder);
  if (out.empty() || asked.also.empty()) return out;
  return difference_of(stored, asked.also, asked.folder).empty() ? "" : out;
}

/// Whether a file is the beginning of a record, or a record of another version, that does not say that it is of another config.
bool is_torn_record(const fs::path& file, const std::string& config_id) {
  constexpr std::string_view head = R"({"schema":{"name":"barrierbench.run")";
  const std::string text = read_input_file(file.string(), record_file);
  std::string begin;
  for (std::size_t i = 0; i < text.size() && begin.size() < head.size(); ++i) {
    if (std::isspace(static_cast<unsigned char>(text[i])) == 0) begin += text[i];
  }
  if (!head.starts_with(begin)) return false;
  const json record = json::parse(text, nullptr, false);
  const json::json_pointer id("/ids/config_id");
  return record.is_discarded() || !record.contains(id) || record.at(id) == config_id;
}

void require_own_checkpoint(const AskedRun& asked) {
  const Checkpoint checkpoint(asked.folder, "");
  if (!checkpoint.exists()) return;
  const auto config = checkpoint.config_there();
  if (!config && (asked.resumes || asked.replace == Replace::torn))
    return;  // Checkpoint::read says what is wrong
  if (!config) {
    throw refusal(checkpoint.file(), "a file that is no checkpoint of this version", asked.replace);
  }
  if (const std::string other = difference_of(*config, asked); !other.empty()) {
    throw refusal(checkpoint.file(),
                  fmt::format("the checkpoint of another run, which is not over: {}", other), asked.replace);
  }
}

}  // namespace

void require_replaceable(const AskedRun& asked, const std::function<void(const std::string&)>& tell) {
  if (asked.replace == Replace::all) return;
  require_own_checkpoint(asked);
  const fs::path file = asked.folder / "run.json";
  std::error_code unreachable;
  if (!fs::exists(file, unreachable)) return;
  if (fs::is_directory(file, unreachable)) return;  // check_writable says that it is in the way
  const bool torn = asked.replace == Replace::torn && is_torn_record(file, asked.now.ids.config_id);
  std::optional<StoredRun> earlier;
  try {
    earlier = read_stored_run(file);
  } catch (const ConfigError& error) {
    if (torn) return;
    throw refusal(file, fmt::format("a file that is no record of this version ({})", error.what()),
                  asked.replace);
  }
  if (!earlier && torn) return;
  if (!earlier) throw refusal(file, "a file that is no record of a run", asked.replace);
  RunRecord& then = earlier->record;
  if (const std::string other = difference_of(then.config.text, asked); !other.empty()) {
    throw refusal(file, fmt::format("the record of another run, \"{}\": {}", then.labels.note, other),
                  asked.replace);
  }
  then.ids.config_id = asked.now.ids.config_id;
  std::string others;
  for (const Difference& difference : differences(then, asked.now))
    others += (others.empty() ? "" : "; ") + difference.what;
  if (!others.empty() && tell) {
    tell(fmt::format("{} is replaced when this run is over, which differs from it: {}", file.string(),
                     others));
  }
}

}  // namespace bb
