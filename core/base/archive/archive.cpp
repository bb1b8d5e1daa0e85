#include "core/base/archive/archive.hpp"

#include <cstring>
#include <stdexcept>

namespace bb {

void GrownLists::add(std::string text) {
  Archive entries(std::move(text));
  while (!entries.at_end()) {
    std::string name, items;
    std::uint64_t n = 0;
    entries(name, n, items);
    count[name] = n;
    bytes[name] += items;
  }
}

void Archive::raw(void* data, std::size_t bytes) {
  if (bytes == 0) return;
  if (!reads_) {
    bytes_.append(static_cast<const char*>(data), bytes);
    return;
  }
  if (bytes > bytes_.size() - at_) throw std::logic_error("archive: read beyond its end");
  std::memcpy(data, bytes_.data() + at_, bytes);
  at_ += bytes;
}

std::size_t Archive::length(std::size_t n) {
  std::uint64_t stored = n;
  raw(&stored, sizeof stored);
  if (reads_ && stored > bytes_.size() - at_) throw std::logic_error("archive: a length beyond its end");
  return static_cast<std::size_t>(stored);
}

void Archive::section(std::string_view name) {
  std::string found(name);
  item(found);
  if (found != name)
    throw std::logic_error("archive: '" + found + "' where '" + std::string(name) + "' is due");
}

}  // namespace bb
