// What the audit found, in words that name bodies and their own vertex numbers.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/audit/surface.hpp"

namespace bb::audit {

/// Names of what is judged.
struct SubjectNames {
  std::vector<std::string> bodies;
  std::vector<int>
      first_vertex;  // [n_bodies] ascending, the first 0: a body has the vertices up to the next one
  std::vector<std::string> obstacles;

  /// "cloth[3 4]": vertices of one body, counted from its first.
  std::string vertices(std::span<const int> ids) const;
};

/// "edge cloth[3 4] crosses triangle ball[0 1 2]".
std::string describe(const AuditMesh& mesh, const PairName& pair, const SubjectNames& names);

}  // namespace bb::audit
