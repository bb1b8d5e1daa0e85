#include "core/base/input/read_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/math/error.hpp"

namespace bb {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& found, const InputKind& kind) {
  throw ConfigError(path.empty() ? "\"\"" : path, found, fmt::format("{}: a readable file", kind.what));
}

const char* type_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISCHR(mode)) return "a character device";
  if (S_ISBLK(mode)) return "a block device";
  if (S_ISSOCK(mode)) return "a socket";
  return "no regular file";
}

void require_regular(const std::string& path, const struct stat& status, const InputKind& kind) {
  if (!S_ISREG(status.st_mode)) refuse(path, type_of(status.st_mode), kind);
}

const char* cause() { return std::strerror(errno); }

[[noreturn]] void too_large(const std::string& path, const std::string& found, const InputKind& kind) {
  throw ConfigError(path, found, fmt::format("{} of at most {} bytes", kind.what, kind.max_bytes));
}

/// All that comes from an open descriptor, which is expected to be `size` bytes.
std::string read_all(int fd, std::uint64_t size, const std::string& path, const InputKind& kind) {
  if (size > kind.max_bytes) too_large(path, fmt::format("{} bytes", size), kind);
  std::string bytes(size, '\0');
  std::size_t done = 0;
  for (;;) {
    if (done == bytes.size()) bytes.resize(done + 4096);  // files of /proc and pipes have no size
    const ::ssize_t n = ::read(fd, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) refuse(path, cause(), kind);
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
    if (done > kind.max_bytes) too_large(path, fmt::format("more than {} bytes", kind.max_bytes), kind);
  }
  bytes.resize(done);
  return bytes;
}

/// An open regular file.
class RegularFile {
 public:
  RegularFile(const std::string& path, const InputKind& kind) : path_(path), kind_(kind) {
    if (path.find('\0') != std::string::npos) refuse("", "a path with a zero byte", kind);
    struct stat status {};
    // before open(): opening a device can already have an effect
    if (path.empty() || ::stat(path.c_str(), &status) != 0)
      refuse(path, path.empty() ? "no path" : cause(), kind);
    require_regular(path, status, kind);
    fd_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (fd_ < 0) refuse(path, cause(), kind);
    if (::fstat(fd_, &status) != 0 || !S_ISREG(status.st_mode)) {  // replaced meanwhile
      ::close(fd_);
      refuse(path, type_of(status.st_mode), kind);
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~RegularFile() { ::close(fd_); }
  RegularFile(const RegularFile&) = delete;
  RegularFile& operator=(const RegularFile&) = delete;

  std::string read() const { return read_all(fd_, size_, path_, kind_); }

 private:
  const std::string& path_;
  const InputKind& kind_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace

void require_regular_file(const std::string& path, const InputKind& kind) { RegularFile(path, kind); }

std::string read_input_file(const std::string& path, const InputKind& kind) {
  if (path == "-" && kind.or_standard_input) {
    static const std::string bytes = read_all(STDIN_FILENO, 0, "the standard input", kind);
    return bytes;
  }
  return RegularFile(path, kind).read();
}

}  // namespace bb
