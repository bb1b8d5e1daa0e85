#include "core/model/mesh/mixed_source.hpp"

namespace bb {
namespace {

constexpr std::string_view mixed_blanks = " \t\r\n";

}  // namespace

bool MixedSource::take_line() {
  if (at_ >= bytes_.size()) return false;
  const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
  line_ = bytes_.substr(at_, end - at_);
  at_ = std::min(end + 1, bytes_.size());
  return true;
}

bool MixedSource::next_line() {
  words_.clear();
  while (words_.empty()) {
    if (!take_line()) return false;
    for (std::size_t at = 0; (at = line_.find_first_not_of(mixed_blanks, at)) != std::string_view::npos;) {
      const std::size_t end = std::min(line_.find_first_of(mixed_blanks, at), line_.size());
      words_.push_back(line_.substr(at, end - at));
      at = end;
    }
  }
  return true;
}

void MixedSource::skip_block() {
  while (take_line() && line_.find_first_not_of(mixed_blanks) != std::string_view::npos) {
  }
}

bool MixedSource::skip_past(std::string_view text) {
  const std::size_t found = bytes_.find(text, at_);
  if (found == std::string_view::npos) return false;
  at_ = found + text.size();
  return take_line() || at_ == bytes_.size();
}

std::string_view MixedSource::next_word() {
  at_ = std::min(bytes_.find_first_not_of(mixed_blanks, at_), bytes_.size());
  const std::size_t end = std::min(bytes_.find_first_of(mixed_blanks, at_), bytes_.size());
  const std::string_view text = bytes_.substr(at_, end - at_);
  at_ = end;
  return text;
}

long long MixedSource::size(std::size_t k) const {
  const std::optional<long long> n = number_in<long long>(word(k));
  if (!n || *n < 0 || *n > (1LL << 40)) {
    fail(fmt::format("\"{}\"", word(k)), fmt::format("an integer from 0 to 2^40 as word {}", k + 1));
  }
  return *n;
}

void MixedSource::require_left(long long n, std::size_t bytes_each) const {
  const std::size_t each = binary_ ? bytes_each : 1;
  if (n < 0 || static_cast<std::size_t>(n) > left() / each) {
    fail(fmt::format("{} things in the {} bytes that are left", n, left()),
         "data as long as its header states");
  }
}

void MixedSource::fail(const std::string& found, const std::string& allowed) const {
  std::string place(line_.substr(0, 60));
  for (char& c : place) {
    if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = '?';
  }
  throw ConfigError(fmt::format("{}: \"{}\"", name_, place), found, allowed);
}

}  // namespace bb
