// Opens the library, checks what it offers, fills a Plugin. All of it happens in a child process first.
#include "core/model/plugin/plugin.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <utility>

#include "core/base/input/names.hpp"
#include "core/math/error.hpp"
#include "core/model/plugin/barrierbench_plugin.h"
#include "core/model/plugin/library_file.hpp"
#include "core/model/plugin/wrappers.hpp"

namespace bb {
namespace {

using EntryPoint = const bb_plugin* (*)();
constexpr const char* symbol = "barrierbench_plugin";

constexpr std::size_t max_entries = 1000;  // of each kind
constexpr int max_smoothness = 1000;       // a function with all derivatives may say so

bool is_snake_case(const char* name) {
  if (!name || !(name[0] >= 'a' && name[0] <= 'z') || std::string_view(name).size() > max_name_bytes)
    return false;
  return std::string_view(name).find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") ==
         std::string_view::npos;
}

std::string text(const char* string) { return string ? string : ""; }

/// The plugin's table. Closes the library again when it is not one of ours.
const bb_plugin& open_plugin(const std::string& file) {
  // with a slash in it, dlopen never searches the library path
  const std::string path = std::filesystem::absolute(file).string();
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw ConfigError(file, text(dlerror()), "a readable shared library");
  const auto fail = [&](const std::string& found, const std::string& allowed) {
    dlclose(library);
    throw ConfigError(file, found, allowed);
  };
  const auto entry = reinterpret_cast<EntryPoint>(dlsym(library, symbol));
  if (!entry) fail(fmt::format("no symbol {}", symbol), fmt::format("a library that exports {}", symbol));
  const bb_plugin* plugin = entry();
  if (!plugin) fail(fmt::format("{}() = NULL", symbol), "a pointer to a bb_plugin");
  if (plugin->abi_version != BB_PLUGIN_ABI_VERSION) {
    fail(fmt::format("abi_version {}", plugin->abi_version),
         fmt::format("abi_version {}", BB_PLUGIN_ABI_VERSION));
  }
  return *plugin;
}

/// Adds what is wrong with one entry: its name and whether all of its calls are there.
void check_entry(const std::string& file, const char* what, const char* name, bool has_calls,
                 std::vector<Violation>& wrong) {
  if (!is_snake_case(name)) {
    wrong.push_back({file, fmt::format("{} named \"{}\"", what, text(name)), "a snake_case name"});
  } else if (!has_calls) {
    wrong.push_back({file, fmt::format("{} \"{}\" with a NULL call", what, name), "every call given"});
  }
}

/// Adds what is wrong with an array; true when its entries can be read.
bool check_array(const std::string& file, const char* what, std::size_t n, const void* array,
                 std::vector<Violation>& wrong) {
  if (n > max_entries) {
    wrong.push_back({file, fmt::format("{} {}", n, what), fmt::format("at most {}", max_entries)});
  } else if (n > 0 && array == nullptr) {
    wrong.push_back({file, fmt::format("{} {} in a NULL array", n, what), "an array, or none of them"});
  }
  return n <= max_entries && (n == 0 || array != nullptr);
}

void check_flag(const std::string& file, const char* what, const char* name, const char* flag, int value,
                std::vector<Violation>& wrong) {
  if (value == 0 || value == 1) return;
  wrong.push_back({file, fmt::format("{} \"{}\" with {} = {}", what, text(name), flag, value), "0 or 1"});
}

void check_shape(const std::string& file, const bb_plugin_shape& s, std::vector<Violation>& wrong) {
  check_entry(file, "shape", s.name, s.eval_double && s.eval_float, wrong);
  check_flag(file, "shape", s.name, "infinite_at_zero", s.infinite_at_zero, wrong);
  if (s.smoothness_at_d_hat < 0 || s.smoothness_at_d_hat > max_smoothness) {
    wrong.push_back(
        {file, fmt::format("shape \"{}\" with smoothness_at_d_hat = {}", text(s.name), s.smoothness_at_d_hat),
         fmt::format("0 to {} continuous derivatives", max_smoothness)});
  }
}

void check(const std::string& file, const bb_plugin& p) {
  std::vector<Violation> wrong;
  if (check_array(file, "shapes", p.n_shapes, p.shapes, wrong)) {
    for (std::size_t i = 0; i < p.n_shapes; ++i) check_shape(file, p.shapes[i], wrong);
  }
  if (check_array(file, "stiffness policies", p.n_policies, p.policies, wrong)) {
    for (std::size_t i = 0; i < p.n_policies; ++i) {
      const bb_plugin_policy& policy = p.policies[i];
      check_entry(file, "stiffness policy", policy.name, policy.fill, wrong);
      check_flag(file, "stiffness policy", policy.name, "needs_hessian", policy.needs_hessian, wrong);
    }
  }
  if (check_array(file, "integrators", p.n_integrators, p.integrators, wrong)) {
    for (std::size_t i = 0; i < p.n_integrators; ++i) {
      const bb_plugin_integrator& s = p.integrators[i];
      check_entry(file, "integrator", s.name, s.predict && s.finish, wrong);
      check_flag(file, "integrator", s.name, "needs_acceleration", s.needs_acceleration, wrong);
    }
  }
  if (p.n_shapes == 0 && p.n_policies == 0 && p.n_integrators == 0) {
    wrong.push_back({file, "a plugin with no entry", "at least one shape, stiffness policy or integrator"});
  }
  if (!wrong.empty()) throw ConfigError(std::move(wrong));
}

Shape wrap_shape(const bb_plugin_shape& s) {
  Shape shape;
  shape.name = s.name;
  shape.doc = text(s.doc);
  shape.smoothness_at_d_hat = s.smoothness_at_d_hat;
  shape.infinite_at_zero = s.infinite_at_zero != 0;
  shape.batch_double = s.eval_double;
  shape.batch_float = s.eval_float;
  shape.self = s.self;
  return shape;
}

Plugin load_here(const std::string& file) {
  const bb_plugin& p = open_plugin(file);
  check(file, p);
  Plugin plugin{file, text(p.name), {}, {}, {}};
  for (std::size_t i = 0; i < p.n_shapes; ++i) plugin.shapes.push_back(wrap_shape(p.shapes[i]));
  for (std::size_t i = 0; i < p.n_policies; ++i) {
    const bb_plugin_policy& policy = p.policies[i];
    plugin.policies.push_back({policy.name, text(policy.doc), [&policy](Refresh refresh, double multiplier) {
                                 return wrap_policy(policy, refresh, multiplier);
                               }});
  }
  for (std::size_t i = 0; i < p.n_integrators; ++i) {
    const bb_plugin_integrator& integrator = p.integrators[i];
    plugin.integrators.push_back(
        {integrator.name, text(integrator.doc), {}, [&integrator](const ParameterMap&) {
           return wrap_integrator(integrator);
         }});
  }
  return plugin;
}

}  // namespace

Plugin load_plugin(const std::string& file) {
  check_library_file(file);
  try_in_child(file, [&file] { load_here(file); });
  return load_here(file);
}

void* find_symbol(const std::string& file, const char* name) {
  void* library = dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD);
  return library ? dlsym(library, name) : nullptr;
}

}  // namespace bb
