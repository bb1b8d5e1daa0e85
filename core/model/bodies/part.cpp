// The list of parts, and what is the same for all of them.
#include "core/model/bodies/part.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/base/parameters/registry.hpp"

namespace bb {

std::span<const PartEntry> part_entries() {
  static const PartEntry all[] = {
#define BB_IS_kernels true
#define BB_IS_host_only false
#define PART(name, doc, convex, where, ...) {#name, doc, parts::name::part(), BB_IS_##where},
#include "core/model/scene/parts/registry.inc"
#undef PART
#undef BB_IS_kernels
#undef BB_IS_host_only
  };
  return all;
}

void require_kernels(std::span<const PartEntry> entries, const Scene& scene, const std::string& where) {
  std::vector<std::string_view> with_kernels;
  for (const PartEntry& entry : entries) {
    if (entry.has_kernels) with_kernels.push_back(entry.name);
  }
  for (const PartEntry& entry : entries) {
    const std::size_t n = entry.part.size(scene);
    if (n == 0 || entry.has_kernels) continue;
    throw ConfigError(where, fmt::format("{} {}, a part without kernels", n, entry.part.elements()),
                      fmt::format("elements of {}", fmt::join(with_kernels, ", ")));
  }
}

void Complaints::number(const std::string& what, double found, bool good, const std::string& allowed) const {
  if (!good || !std::isfinite(found)) (*this)(what, fmt::format("{}", found), allowed);
}

void Complaints::model(const std::string& what, const std::string& found,
                       std::vector<std::string> names) const {
  names.emplace_back("none");
  if (std::find(names.begin(), names.end(), found) != names.end()) return;
  (*this)(what, '"' + found + '"', one_of_text(found, names));
}

template <>
Settings<Material> list_of() {
  std::string doc;
  for (const PartEntry& entry : part_entries()) {
    const std::string_view more = entry.part.keys_doc();
    doc += (doc.empty() || more.empty() ? "" : " ") + std::string(more);
  }
  Settings<Material> out(doc);
  for (const PartEntry& entry : part_entries()) entry.part.add_keys(out);
  return out;
}

}  // namespace bb
