// Who holds how much memory of an executor, by name.
#pragma once

#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>

namespace bb::exec {

/// Too little memory for a buffer. what() names it, the bytes requested, those in use and the limit.
struct OutOfMemory : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class MemoryLedger {
 public:
  /// Bytes that may be in use at a time; 0: no limit of its own.
  void set_limit(std::size_t bytes) { limit_ = bytes; }
  /// Errors: OutOfMemory when the limit is passed; nothing is counted then.
  void add(const std::string& name, std::size_t bytes);
  void remove(const std::string& name, std::size_t bytes);

  std::size_t bytes() const { return bytes_; }
  /// What the limit leaves; without one the largest number.
  std::size_t left() const;
  std::size_t peak() const { return peak_; }
  /// name -> bytes in use; names without bytes are not there.
  const std::map<std::string, std::size_t>& by_name() const { return by_name_; }
  /// name -> bytes at the moment of the peak.
  const std::map<std::string, std::size_t>& at_peak() const { return at_peak_; }
  std::string refusal(const std::string& name, std::size_t bytes) const;

 private:
  std::size_t limit_ = 0, bytes_ = 0, peak_ = 0;
  std::map<std::string, std::size_t> by_name_, at_peak_;
};

/// "1.5 GiB".
std::string bytes_text(std::size_t bytes);

}  // namespace bb::exec
