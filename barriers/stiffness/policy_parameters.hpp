// The parameters of a policy as its struct lists them: rows for config, help, schema and record, and the way from a map of
// values into the struct.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "barriers/matching.hpp"
#include "barriers/stiffness/registry.hpp"

namespace bb {

/// P::describe(list) names every parameter once: `list.flag("name", &P::member, "meaning")`. Defaults are what P() holds.
template <class P>
class PolicyParameters {
 public:
  explicit PolicyParameters(PolicyUse use) : use_(use) { P::describe(*this); }

  // --- what describe() is given
  /// Whether the policy is described as that of a strain limit.
  bool of_limit() const { return use_ == PolicyUse::limit; }
  void flag(const char* name, bool P::*member, const char* doc) {
    add({name, bb::flag(), P().*member, doc},
        [=](const ParameterMap& map, P& out) { out.*member = boolean(map, name); });
  }
  /// Within [0, 1].
  void fraction(const char* name, double P::*member, const char* unit, const char* doc) {
    add({name, number_in(0, 1, unit), P().*member, doc},
        [=](const ParameterMap& map, P& out) { out.*member = bb::number(map, name); });
  }
  /// A number > 0 with a default.
  void positive(const char* name, double P::*member, const char* unit, const char* doc) {
    add({name, bb::positive(unit), P().*member, doc},
        [=](const ParameterMap& map, P& out) { out.*member = bb::number(map, name); });
  }
  /// A number > 0, or nothing.
  void positive(const char* name, std::optional<double> P::*member, const char* unit, const char* doc) {
    add({name, bb::positive(unit), no_default, doc},
        [=](const ParameterMap& map, P& out) { out.*member = optional_number(map, name); });
  }
  /// A text of at most so many bytes, or nothing.
  void text(const char* name, std::string P::*member, std::size_t most, const char* doc) {
    add({name, text_up_to(most), no_default, doc}, [=](const ParameterMap& map, P& out) {
      const auto given = map.find(name);
      if (given != map.end()) out.*member = std::get<std::string>(given->second);
    });
  }
  /// The stiffness itself, > 0, which the matching rule supplies where it is left out.
  void matched(const char* name, double P::*member, const char* unit, const char* doc) {
    matched_ = name;
    add({name, bb::positive(unit), no_default, doc}, [=](const ParameterMap& map, P& out) {
      const std::optional<double> value = optional_number(map, name);
      if (!value) {
        throw ConfigError(fmt::format("stiffness_policy/{}", name), "nothing",
                          fmt::format("a number > 0 ({})", unit));
      }
      out.*member = *value;
    });
  }
  /// Constants that publications give instead of kappa; the config turns them into it.
  void published_constants() {
    for (const KappaConvention& one : kappa_conventions()) {
      rows_.push_back({one.name, bb::positive(one.unit), no_default, one.doc});
    }
  }
  /// One of the words, which stand in the order of the enumerators; only the first n_allowed may be chosen.
  template <class Enum>
  void choice(const char* name, Enum P::*member, std::initializer_list<const char*> words, const char* doc,
              std::size_t n_allowed = 0) {
    std::vector<std::string> allowed(words.begin(), words.end());
    const std::string fallback = allowed[static_cast<std::size_t>(P().*member)];
    if (n_allowed > 0) allowed.resize(n_allowed);
    add({name, word(allowed), fallback, doc}, [=](const ParameterMap& map, P& out) {
      for (std::size_t i = 0; i < allowed.size(); ++i) {
        if (bb::text(map, name) == allowed[i]) out.*member = static_cast<Enum>(i);
      }
    });
  }
  /// One of the words, which stand in the order of the enumerators, or nothing, which leaves what P() holds.
  template <class Enum>
  void optional_choice(const char* name, Enum P::*member, std::initializer_list<const char*> words,
                       const char* doc) {
    const std::vector<std::string> allowed(words.begin(), words.end());
    add({name, word(allowed), no_default, doc}, [=](const ParameterMap& map, P& out) {
      if (!map.contains(name)) return;
      for (std::size_t i = 0; i < allowed.size(); ++i) {
        if (bb::text(map, name) == allowed[i]) out.*member = static_cast<Enum>(i);
      }
    });
  }
  void refresh(Refresh P::*member) {
    add(refresh_parameter(),
        [=](const ParameterMap& map, P& out) { out.*member = require_refresh(bb::text(map, "refresh")); });
  }

  // --- what the registry takes
  const std::vector<Parameter>& rows() const { return rows_; }
  const std::string& matched() const { return matched_; }
  /// From a complete map. Errors: ConfigError for what P::check refuses.
  P values(const ParameterMap& complete) const {
    const P out = unchecked(complete);
    Refusals refusals;
    out.check(refusals);
    if (!refusals.violations.empty()) throw ConfigError(std::move(refusals.violations));
    return out;
  }
  /// The same without what P::check refuses.
  P unchecked(const ParameterMap& complete) const {
    P out;
    for (const auto& set : setters_) set(complete, out);
    return out;
  }

 private:
  /// Takes what P::check complains of.
  struct Refusals {
    std::vector<Violation> violations;
    void operator()(const char* name, std::string found, std::string allowed) {
      violations.push_back({fmt::format("stiffness_policy/{}", name), std::move(found), std::move(allowed)});
    }
    void operator()(const char* name, double found, std::string allowed) {
      (*this)(name, fmt::format("{}", found), std::move(allowed));
    }
    /// Of no single parameter.
    void all(std::string found, std::string allowed) {
      violations.push_back({"stiffness_policy", std::move(found), std::move(allowed)});
    }
    static std::string at_most(const char* name, double value) {
      return fmt::format("at most {} = {}", name, value);
    }
  };
  void add(Parameter row, std::function<void(const ParameterMap&, P&)> set) {
    rows_.push_back(std::move(row));
    setters_.push_back(std::move(set));
  }

  PolicyUse use_;
  std::vector<Parameter> rows_;
  std::vector<std::function<void(const ParameterMap&, P&)>> setters_;
  std::string matched_;
};

}  // namespace bb
