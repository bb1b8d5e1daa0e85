// energy: value, gradient, exact and projected Hessian of one element of a part.
#include "core/model/bodies/part.hpp"
#include "experiments/eval/kinds.hpp"

namespace bb::eval {

template <class T>
Answer answer::energy(Query& q) {
  std::vector<std::string> names;
  for (const PartEntry& entry : part_entries()) {
    for (const std::string& name : entry.part.element_names()) names.push_back(name);
  }
  const std::string name = q.choice("model", names);
  if (q.wrong()) q.finish();  // which fields there are depends on the model
  Answer a;
  for (const PartEntry& entry : part_entries()) {
    const std::vector<std::string> own = entry.part.element_names();
    if (std::find(own.begin(), own.end(), name) == own.end()) continue;
    const ElementAnswer element = entry.part.element(name, q);
    a.number("energy", element.energy);
    a.vector("gradient", element.gradient);
    a.matrix("hessian", element.hessian);
    a.matrix("hessian_psd", element.hessian_psd);
    if (!element.status.empty()) a.status(element.status);
  }
  return a;
}

BB_EVAL_KIND(energy);

}  // namespace bb::eval
