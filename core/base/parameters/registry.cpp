// Nearest names and the text of the error for an unknown one.
#include "core/base/parameters/registry.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

#include "core/base/input/names.hpp"

namespace bb {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_name(std::string_view name, const std::vector<std::string>& names) {
  std::size_t best = name.size() / 2 + 1;
  std::string nearest;
  for (const std::string& candidate : names) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string one_of_text(std::string_view found, const std::vector<std::string>& names) {
  const std::string nearest = nearest_name(found, names);
  return fmt::format("one of {}{}", fmt::join(names, ", "),
                     nearest.empty() ? "" : " (did you mean " + nearest + "?)");
}

ConfigError unknown_name(std::string_view where, std::string_view found,
                         const std::vector<std::string>& names) {
  return ConfigError(std::string(where), fmt::format("\"{}\"", shortened(found)), one_of_text(found, names));
}

}  // namespace bb
