// fuzz_seeds FOLDER: the seeds of every target in FOLDER/TARGET/ and its dictionary in FOLDER/TARGET.dict.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/seeds.hpp"

namespace {

/// As libFuzzer reads it: bytes beyond printable ASCII, quotes and backslashes are escaped.
std::string dictionary_line(const std::string& word) {
  std::string out = "\"";
  for (const char c : word) {
    const auto byte = static_cast<unsigned char>(c);
    char escaped[5];
    std::snprintf(escaped, sizeof escaped, "\\x%02X", byte);
    if (c == '"' || c == '\\' || byte < 0x20 || byte > 0x7e) {
      out += escaped;
    } else {
      out += c;
    }
  }
  return out + "\"\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: fuzz_seeds FOLDER\n", stderr);
    return 2;
  }
  const std::filesystem::path out = argv[1];
  for (const std::string& target : bb::fuzz::target_names()) {
    std::filesystem::create_directories(out / target);
    int number = 0;
    for (const std::string& seed : bb::fuzz::seeds_of(target)) {
      std::ofstream(out / target / std::to_string(number++), std::ios::binary) << seed;
    }
    std::ofstream dictionary(out / (target + ".dict"));
    for (const std::string& word : bb::fuzz::words_of(target)) dictionary << dictionary_line(word);
  }
}
