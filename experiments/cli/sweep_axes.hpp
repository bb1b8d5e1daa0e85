// The axes of a sweep file as lists of entries: what each is called, and what it sets.
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "core/math/error.hpp"

namespace bb {

/// One entry of an axis.
struct AxisEntry {
  std::string label;
  nlohmann::json set;      // pointer -> value
  bool reference = false;  // the others are compared with it
};
using Axis = std::vector<AxisEntry>;

/// Entries of an axis, which has the form that the list of the file requests, before it is expanded; of zipped axes those of
/// the first.
std::size_t count_entries(const nlohmann::json& axis);

/// An axis in one of its forms: values of a pointer, a range of it, cases, or axes zipped entry by entry. What is wrong with
/// it is appended; then the entries are void. where: FILE#/axes/N.
Axis expand_axis(const std::string& where, const nlohmann::json& axis, std::vector<Violation>& violations);

/// Every pointer that an entry sets.
std::set<std::string> pointers_of(const Axis& axis);

/// Whether an axis changes what is compared (method, formulation, strain limit, matching), and not the problem that
/// it is compared on. One entry that does is enough.
bool changes_formulation(const Axis& axis);

/// A pointer as it stands in front of "=" in an override: with "=" in it, its end would become part of the value.
void check_pointer(const std::string& where, const std::string& pointer, std::vector<Violation>& violations);
void check_pointers(const std::string& where, const nlohmann::json& set, std::vector<Violation>& violations);

}  // namespace bb
