#include "experiments/run/keep_record.hpp"

namespace bb {
namespace {

/// The same text for as long as the program runs: a Number keeps its reason as a pointer.
const char* kept(const std::string& word) {
  static std::set<std::string> words;
  return words.insert(word).first->c_str();
}

}  // namespace

void keep(Archive& archive, Number& number) {
  std::string reason = number.status ? number.status : "";
  archive(number.value, reason);
  if (archive.reads()) number.status = reason.empty() ? nullptr : kept(reason);
}

void keep(Archive& archive, PhaseTimes& times) { archive(times.s); }

void keep(Archive& archive, JsonText& text) { archive(text.text); }

void keep(Archive& archive, SolverCounts& counts) { archive(counts.values); }

}  // namespace bb
