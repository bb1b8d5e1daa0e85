#include "core/base/record/kept_hash.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <fstream>

#include "core/base/record/provenance.hpp"

namespace bb {
namespace {

namespace fs = std::filesystem;

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

double seconds(const timespec& time) {
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Empty where the file is not there or holds anything else.
std::string read_hash(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text;
  if (!std::getline(in, text) || text.size() != 64) return {};
  return text.find_first_not_of("0123456789abcdef") == std::string::npos ? text : "";
}

void keep(const fs::path& folder, const std::string& name, const std::string& hash) {
  std::error_code error;
  fs::create_directories(folder, error);
  const fs::path part = folder / fmt::format("{}.{}.part", name, ::getpid());
  {
    std::ofstream out(part, std::ios::binary);
    out << hash << '\n';
    if (!out.flush()) {
      fs::remove(part, error);
      return;
    }
  }
  fs::rename(part, folder / name, error);
  if (error) fs::remove(part, error);
}

}  // namespace

fs::path hashes_folder() {
  if (const std::string own = variable("BARRIERBENCH_CACHE"); !own.empty()) return fs::path(own) / "hashes";
  if (const std::string cache = variable("XDG_CACHE_HOME"); !cache.empty())
    return fs::path(cache) / "barrierbench/hashes";
  const std::string home = variable("HOME");
  return home.empty() ? fs::path() : fs::path(home) / ".cache/barrierbench/hashes";
}

std::string kept_sha256(const std::string& path, const fs::path& folder, double settled_s) {
  struct stat before {};
  if (folder.empty() || ::stat(path.c_str(), &before) != 0) return sha256_file(path);
  const std::string name = fmt::format("{:x}-{:x}-{}-{}.{:09}-{}.{:09}", before.st_dev, before.st_ino,
                                       before.st_size, before.st_mtim.tv_sec, before.st_mtim.tv_nsec,
                                       before.st_ctim.tv_sec, before.st_ctim.tv_nsec);
  if (const std::string kept = read_hash(folder / name); !kept.empty()) return kept;
  const std::string hash = sha256_file(path);
  timespec now{};
  std::timespec_get(&now, TIME_UTC);
  const double changed = std::max(seconds(before.st_mtim), seconds(before.st_ctim));
  if (!hash.empty() && seconds(now) - changed >= settled_s) keep(folder, name, hash);
  return hash;
}

}  // namespace bb
