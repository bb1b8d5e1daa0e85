#include "core/exec/memory_ledger.hpp"

#include <cstdio>
#include <limits>

namespace bb::exec {

std::string bytes_text(std::size_t bytes) {
  const char* units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  double value = static_cast<double>(bytes);
  int unit = 0;
  for (; value >= 1024 && unit < 4; ++unit) value /= 1024;
  char text[40];
  std::snprintf(text, sizeof text, unit == 0 ? "%.0f %s" : "%.2f %s", value, units[unit]);
  return text;
}

std::string MemoryLedger::refusal(const std::string& name, std::size_t bytes) const {
  std::string text =
      "no memory for " + name + ": " + bytes_text(bytes) + " requested, " + bytes_text(bytes_) + " in use";
  if (limit_ > 0) text += " of " + bytes_text(limit_);
  return text;
}

std::size_t MemoryLedger::left() const {
  if (limit_ == 0) return std::numeric_limits<std::size_t>::max();
  return bytes_ < limit_ ? limit_ - bytes_ : 0;
}

void MemoryLedger::add(const std::string& name, std::size_t bytes) {
  if (bytes > left()) throw OutOfMemory(refusal(name, bytes));
  by_name_[name] += bytes;
  bytes_ += bytes;
  if (bytes_ <= peak_) return;
  peak_ = bytes_;
  at_peak_ = by_name_;
}

void MemoryLedger::remove(const std::string& name, std::size_t bytes) {
  const auto found = by_name_.find(name);
  found->second -= bytes;
  if (found->second == 0) by_name_.erase(found);
  bytes_ -= bytes;
}

}  // namespace bb::exec
