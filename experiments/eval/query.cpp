// Reading and judging the fields of one query.
#include "experiments/eval/query.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/parameters/registry.hpp"

namespace bb::eval {
namespace {

using nlohmann::json;

/// A value as the user wrote it; arrays and objects by their kind and size only.
std::string shown(const json& v) {
  if (v.is_array()) return "an array of " + std::to_string(v.size());
  if (v.is_object()) return "an object";
  return v.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string size_text(int size, const char* what) {
  return size < 0 ? std::string("a list of ") + what : "a list of " + std::to_string(size) + " " + what;
}

double smallest(const Range& range) {
  if (std::isfinite(range.low) && !range.low_open) return range.low;
  return range.high == 1 ? 0.5 : 1;
}

}  // namespace

bool Query::has(std::string_view name) const { return object_.contains(name); }

void Query::complain(const std::string& name, const std::string& found, const std::string& allowed) {
  violations_.push_back({"/" + name, found, allowed});
}

const json* Query::find(const char* name) {
  known_.insert(name);
  const auto at = object_.find(name);
  if (at != object_.end()) return &*at;
  complain(name, "nothing", "this field is required");
  return nullptr;
}

std::string Query::word(const char* name) {
  const json* v = find(name);
  if (v == nullptr) return {};
  if (v->is_string()) return v->get<std::string>();
  complain(name, shown(*v), "a string");
  return {};
}

std::string Query::choice(const char* name, const std::vector<std::string>& allowed) {
  const std::size_t before = violations_.size();
  std::string found = word(name);
  if (violations_.size() == before) {
    if (std::find(allowed.begin(), allowed.end(), found) != allowed.end()) return found;
    const ConfigError unknown = unknown_name("/" + std::string(name), found, allowed);
    violations_.push_back(unknown.violations().front());
  }
  return allowed.front();
}

std::string Query::choice_or(const char* name, const std::vector<std::string>& allowed) {
  if (has(name)) return choice(name, allowed);
  known_.insert(name);
  return allowed.front();
}

bool Query::flag_or(const char* name, bool fallback) {
  known_.insert(name);
  if (!has(name)) return fallback;
  const json& v = object_[name];
  if (v.is_boolean()) return v.get<bool>();
  complain(name, shown(v), "true or false");
  return fallback;
}

int Query::integer(const char* name, int low, int high) {
  const json* v = find(name);
  if (v == nullptr) return low;
  const double d = v->is_number() ? v->get<double>() : std::nan("");
  if (d >= low && d <= high && d == std::floor(d)) return static_cast<int>(d);
  complain(name, shown(*v), "an integer from " + std::to_string(low) + " to " + std::to_string(high));
  return low;
}

double Query::checked(const json& value, const std::string& where, const Range& range) {
  if (value.is_number()) {
    const double exact = value.get<double>();
    const double v = single_ ? static_cast<double>(static_cast<float>(exact)) : exact;
    if (range.contains(v)) return v == 0 ? 0 : v;  // -0 is the number 0
    const bool lost = range.contains(exact);       // in range as double, not as float
    complain(where, shown(value), std::string(range.text) + (lost ? " after rounding to float" : ""));
  } else {
    complain(where, shown(value), range.text);
  }
  return smallest(range);
}

double Query::number(const char* name, const Range& range) {
  const json* v = find(name);
  return v == nullptr ? smallest(range) : checked(*v, name, range);
}

double Query::number_or(const char* name, const Range& range, double fallback) {
  if (has(name)) return number(name, range);
  known_.insert(name);
  return single_ ? static_cast<double>(static_cast<float>(fallback)) : fallback;
}

std::vector<double> Query::list(const char* name, int size, const Range& range) {
  const json* v = find(name);
  std::vector<double> dummy(static_cast<std::size_t>(std::max(size, 1)), smallest(range));
  if (v == nullptr) return dummy;
  if (!v->is_array() || v->empty() || (size >= 0 && v->size() != static_cast<std::size_t>(size))) {
    complain(name, shown(*v), size_text(size, "numbers"));
    return dummy;
  }
  std::vector<double> out;
  for (std::size_t i = 0; i < v->size(); ++i) {
    out.push_back(checked((*v)[i], name + ("/" + std::to_string(i)), range));
  }
  return out;
}

MatX<double> Query::rows(const char* name, int n_rows, int n_cols) {
  const json* v = find(name);
  MatX<double> dummy = MatX<double>::Ones(std::max(n_rows, 1), std::max(n_cols, 1));
  if (v == nullptr) return dummy;
  if (!v->is_array() || v->empty() || (n_rows >= 0 && v->size() != static_cast<std::size_t>(n_rows))) {
    complain(name, shown(*v), size_text(n_rows, "rows"));
    return dummy;
  }
  const json& first = (*v)[0];
  const std::size_t width = n_cols >= 0        ? static_cast<std::size_t>(n_cols)
                            : first.is_array() ? first.size()
                                               : 0;
  MatX<double> out(static_cast<Eigen::Index>(v->size()), static_cast<Eigen::Index>(width));
  for (std::size_t i = 0; i < v->size(); ++i) {
    const json& row = (*v)[i];
    const std::string where = name + ("/" + std::to_string(i));
    if (!row.is_array() || row.size() != width || width == 0) {
      complain(where, shown(row), size_text(width == 0 ? -1 : static_cast<int>(width), "numbers"));
      return dummy;
    }
    for (std::size_t j = 0; j < width; ++j) {
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          checked(row[j], where + "/" + std::to_string(j), kFinite);
    }
  }
  return out;
}

std::vector<int> Query::indices(const char* name, int high) {
  const json* v = find(name);
  if (v == nullptr) return {};
  const std::string allowed = "integers from 0 to " + std::to_string(high);
  if (!v->is_array() || v->empty()) {
    complain(name, shown(*v), "a list of " + allowed);
    return {};
  }
  std::vector<int> out;
  for (std::size_t i = 0; i < v->size(); ++i) {
    const json& entry = (*v)[i];
    const double d = entry.is_number() ? entry.get<double>() : -1;
    if (!(d >= 0 && d <= high && d == std::floor(d))) {
      complain(name + ("/" + std::to_string(i)), shown(entry), allowed);
      return {};
    }
    out.push_back(static_cast<int>(d));
  }
  return out;
}

void Query::finish() {
  for (const auto& [key, value] : object_.items()) {
    if (known_.contains(key)) continue;
    complain(key, "a field that this kind does not have", one_of_text(key, {known_.begin(), known_.end()}));
  }
  if (!violations_.empty()) throw ConfigError(violations_);
}

}  // namespace bb::eval
