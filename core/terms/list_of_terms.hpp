// The terms of a run, as the matrix engine of the host (HostTerm) or of an executor (ExecutorTerm) reads them.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace bb {

/// In the order of registry.inc, which is that of the sums.
template <class Term>
class ListOfTerms {
 public:
  void add(std::unique_ptr<Term> term) { terms_.push_back(std::move(term)); }
  auto begin() const { return terms_.begin(); }
  auto end() const { return terms_.end(); }
  std::size_t size() const { return terms_.size(); }
  Term& operator[](std::size_t i) const { return *terms_[i]; }
  /// The first term of that class, or null.
  template <class T>
  T* find() const {
    for (const auto& term : terms_) {
      if (T* found = dynamic_cast<T*>(term.get())) return found;
    }
    return nullptr;
  }

 private:
  std::vector<std::unique_ptr<Term>> terms_;
};

}  // namespace bb
