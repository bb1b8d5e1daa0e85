// The sections of a config one by one, and whether two of them are the same. Private to experiments/config.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "experiments/config/run_config.hpp"

namespace bb {

/// Calls visit(key in the document, member of RunConfig) for every section but the scene.
template <class Visit>
void for_each_section(const Visit& visit) {
  visit("method", &RunConfig::method);
  visit("formulation", &RunConfig::formulation);
  visit("strain_limit", &RunConfig::strain_limit);
  visit("matching", &RunConfig::matching);
  visit("contact", &RunConfig::contact);
  visit("friction", &RunConfig::friction);
  visit("integrator", &RunConfig::integrator);
  visit("time", &RunConfig::time);
  visit("step_solver", &RunConfig::step_solver);
  visit("hessian", &RunConfig::hessian);
  visit("linear_solver", &RunConfig::linear_solver);
  visit("precision", &RunConfig::precision);
  visit("device", &RunConfig::device);
  visit("passes", &RunConfig::passes);
  visit("diagnose", &RunConfig::diagnose);
  visit("seeds", &RunConfig::seeds);
  visit("output", &RunConfig::output);
  visit("threads", &RunConfig::threads);
}

/// Whether two sections are written alike: numbers to the last bit, since -0 is written otherwise than 0.
template <class T>
bool same(const T& a, const T& b);

#define SECTION(type, doc)                                 \
  inline bool same_members(const type& a, const type& b) { \
    return true
#define SETTING(type, member, name, rule, doc, ...) &&same(a.member, b.member)
#define NEST(type, member, name, settings) &&same(a.member, b.member)
#define OWN(...) &&same(a.parameters, b.parameters)
#define END_SECTION \
  ;                 \
  }
#include "experiments/config/settings.inc"

inline bool same_members(const PolicyConfig& a, const PolicyConfig& b) {
  return a.name == b.name && same(a.scale, b.scale) && same(a.parameters, b.parameters);
}

template <class T>
bool same(const T& a, const T& b) {
  if constexpr (std::is_same_v<T, double>) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  } else if constexpr (std::is_same_v<T, Vec3d>) {
    return same(a[0], b[0]) && same(a[1], b[1]) && same(a[2], b[2]);
  } else if constexpr (requires { same_members(a, b); }) {
    return same_members(a, b);
  } else if constexpr (requires { a.valueless_by_exception(); }) {
    return a.index() == b.index() &&
           std::visit([&](const auto& held) { return same(held, std::get<std::decay_t<decltype(held)>>(b)); },
                      a);
  } else if constexpr (requires { a.has_value(); }) {
    return a.has_value() == b.has_value() && (!a.has_value() || same(*a, *b));
  } else if constexpr (requires { typename T::mapped_type; }) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
      return x.first == y.first && same(x.second, y.second);
    });
  } else if constexpr (requires { a.front(); } && !std::is_same_v<T, std::string>) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const auto& x, const auto& y) { return same(x, y); });
  } else {
    return a == b;
  }
}

}  // namespace bb
