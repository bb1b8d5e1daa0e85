#include "experiments/config/hashed_file.hpp"

#include <nlohmann/json.hpp>

#include "core/base/record/provenance.hpp"

namespace bb {

std::string hash_of(const std::string& path, const InputKind& kind, const std::string& pointer,
                    const Reader& reader) {
  try {
    return sha256_hex(read_input_file(path, kind));
  } catch (const ConfigError& error) {
    const Violation& wrong = error.violations().front();
    reader.complain(pointer, nlohmann::json(path).dump() + ": " + wrong.found, wrong.allowed);
    return "";
  }
}

void read_hashed(const nlohmann::json& object, const InputKind& kind, const std::string& pointer,
                 const Reader& reader, HashedFile& file) {
  file.path = object["file"].get<std::string>();
  file.sha256 = hash_of(file.path, kind, pointer + "/file", reader);
  if (file.sha256.empty() || !object.contains("sha256") || object["sha256"] == file.sha256) return;
  reader.complain(pointer + "/sha256", object["sha256"].dump(),
                  "\"" + file.sha256 + "\", the hash of " + file.path);
}

std::string unchanged(const HashedFile& file, const InputKind& kind) {
  std::string bytes = read_input_file(file.path, kind);
  if (sha256_hex(bytes) == file.sha256) return bytes;
  throw ConfigError(file.path, "a file that has changed since the config was read", "SHA-256 " + file.sha256);
}

}  // namespace bb
