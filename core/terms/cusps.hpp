// Elements whose energy has a cusp at the iterate (ElementFamily::cusps): it is no minimum there, whatever the first and second derivatives
// that such elements have chosen say.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "core/energy/families/element_family.hpp"
#include "core/exec/host_executor.hpp"
#include "core/model/scene/scene.hpp"

namespace bb {

struct Cusps {
  std::size_t count = 0;
  std::string_view term;      // of the first element
  std::size_t element = 0;    // the first one's number in its family
  std::vector<int> vertices;  // of all of them, element after element
  std::size_t width = 0;      // of the first one: so many vertices are its own

  /// Those of a family of `of`.
  void add(std::string_view of, const ElementFamily& family, const PositionsView& x);
};

/// The elastic elements of a scene on the host, for a potential whose own are elsewhere. What has crept is not known: rest shapes
/// are those that are given.
class CuspSearch {
 public:
  CuspSearch(const Scene& scene, Precision precision);
  /// t_end: end of the step, s.
  Cusps find(const PositionsView& x, double t_end) const;

 private:
  struct Named {
    std::string_view term;
    std::unique_ptr<ElementFamily> family;
  };
  exec::HostExecutor executor_;
  std::vector<Named> families_;
};

}  // namespace bb
