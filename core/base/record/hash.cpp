// SHA-256 of bytes, files, states and configs.
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/base/record/places.hpp"
#include "core/base/record/provenance.hpp"

namespace bb {
static_assert(std::endian::native == std::endian::little, "state_hash hashes memory as it lies");

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    if (context_ == nullptr || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) {
      throw std::runtime_error("sha256: OpenSSL refused to start");
    }
  }
  /// Of what was added so far; both go on by themselves.
  Sha256 copy() const {
    Sha256 out;
    if (EVP_MD_CTX_copy_ex(out.context_.get(), context_.get()) != 1)
      throw std::runtime_error("sha256: OpenSSL failed");
    return out;
  }
  void add(const void* data, std::size_t n) {
    if (EVP_DigestUpdate(context_.get(), data, n) != 1) throw std::runtime_error("sha256: OpenSSL failed");
  }
  std::string hex() {
    std::array<unsigned char, 32> digest{};
    unsigned int n = 0;
    EVP_DigestFinal_ex(context_.get(), digest.data(), &n);
    static constexpr char kDigits[] = "0123456789abcdef";
    std::string out;
    for (unsigned char byte : digest) {
      out += kDigits[byte >> 4];
      out += kDigits[byte & 15];
    }
    return out;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

namespace {

void drop_places(nlohmann::json& j) {
  if (!j.is_structured()) return;
  if (j.is_object() && j.contains("sha256") && j.contains("file") && j["file"].is_string()) {
    j["file"] = std::filesystem::path(j["file"].get<std::string>()).extension().string();
  }
  for (nlohmann::json& inner : j) drop_places(inner);
}

}  // namespace

struct RunningHash::Context {
  Sha256 hash;
};

RunningHash::RunningHash() : context_(std::make_unique<Context>()) {}
RunningHash::~RunningHash() = default;
RunningHash::RunningHash(RunningHash&&) noexcept = default;
RunningHash& RunningHash::operator=(RunningHash&&) noexcept = default;

void RunningHash::add(std::string_view bytes) {
  context_->hash.add(bytes.data(), bytes.size());
  size_ += bytes.size();
}

FilePrefix RunningHash::so_far() const { return {size_, context_->hash.copy().hex()}; }

std::optional<RunningHash> hash_of_prefix(const std::string& path, const FilePrefix& prefix) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "re"), std::fclose);
  if (file == nullptr) return std::nullopt;
  RunningHash hash;
  std::vector<char> buffer(1 << 16);
  for (std::uint64_t left = prefix.bytes; left > 0;) {
    const std::size_t wanted = std::min<std::uint64_t>(left, buffer.size());
    const std::size_t n = std::fread(buffer.data(), 1, wanted, file.get());
    if (n == 0) return std::nullopt;
    hash.add({buffer.data(), n});
    left -= n;
  }
  if (hash.so_far().sha256 != prefix.sha256) return std::nullopt;
  return hash;
}

std::string sha256_hex(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes.data(), bytes.size());
  return hash.hex();
}

std::string sha256_file(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return {};  // a FIFO or a device may have no end
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "re"), std::fclose);
  if (file == nullptr) return {};
  Sha256 hash;
  std::vector<char> buffer(1 << 16);
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), file.get()))
    hash.add(buffer.data(), n);
  return std::ferror(file.get()) != 0 ? std::string() : hash.hex();
}

std::string state_hash(std::span<const double> values) {
  Sha256 hash;
  hash.add(values.data(), values.size_bytes());
  return hash.hex();
}

std::string state_hash(const Positions& x) {
  return state_hash(std::span<const double>(x.data(), static_cast<std::size_t>(x.size())));
}

std::string config_id(std::string_view config_json) {
  nlohmann::json j = nlohmann::json::parse(config_json, nullptr, false);  // sorts keys
  if (j.is_discarded()) throw std::invalid_argument("config_id: not JSON");
  return config_id_of(std::move(j));
}

nlohmann::json without_places(nlohmann::json value) {
  drop_places(value);
  return value;
}

std::string config_id_of(nlohmann::json config) {
  if (config.is_object()) config.erase("threads");  // no bit of a result depends on it
  return sha256_hex(without_places(std::move(config)).dump());
}

}  // namespace bb
