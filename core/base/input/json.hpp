// The one JSON reader: configs, sweeps, presets, records, queries and values of --set all go through it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/base/input/read_file.hpp"
#include "core/math/error.hpp"

namespace bb {

/// Arrays and objects inside each other: a config has 7 levels. What reads, checks and writes JSON recurses.
inline constexpr int max_json_depth = 64;
/// 2^53: up to here every integer is a double too, so that no reader of the file rounds it.
inline constexpr std::int64_t max_json_integer = std::int64_t{1} << 53;

enum class JsonFault { syntax, number_range, large_integer, repeated_key, too_deep };

/// What is wrong with a JSON text; `where` is source:line.
class JsonError : public ConfigError {
 public:
  JsonError(JsonFault fault, std::string where, std::string found, std::string allowed)
      : ConfigError(std::move(where), std::move(found), std::move(allowed)), fault_(fault) {}
  JsonFault fault() const { return fault_; }

 private:
  JsonFault fault_;
};

/// Whether integers beyond max_json_integer are refused, or read as the nearest double like any other number.
enum class LargeIntegers { refused, rounded };

/// Text to a value. Errors: JsonError for bad syntax, a number beyond double, a key that is there twice in
/// one object, more than max_json_depth levels, an integer beyond max_json_integer. Cost O(length).
nlohmann::json parse_json(const std::string& text, const std::string& source,
                          LargeIntegers large_integers = LargeIntegers::refused);

/// The same from a file. Errors: also those of read_input_file.
nlohmann::json read_json_file(const std::string& path, const InputKind& kind);

}  // namespace bb
