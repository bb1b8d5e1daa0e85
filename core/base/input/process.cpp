#include "core/base/input/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

extern char** environ;  // of the C library

namespace bb {
namespace {

constexpr std::size_t most_input = 4096;

/// Both ends of a pipe, closed with it, and not handed on but by what copies them.
class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_, O_CLOEXEC) != 0) {
      throw std::runtime_error(fmt::format("no pipe: {}", std::strerror(errno)));
    }
  }
  ~Pipe() { close_read(), close_write(); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int read_end() const { return ends_[0]; }
  int write_end() const { return ends_[1]; }
  void close_read() { close(ends_[0]); }
  void close_write() { close(ends_[1]); }

 private:
  static void close(int& end) {
    if (end >= 0) ::close(end);
    end = -1;
  }
  int ends_[2] = {-1, -1};
};

std::vector<std::string> environment_with(const std::vector<std::pair<std::string, std::string>>& more) {
  std::vector<std::string> out;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    bool replaced = false;
    for (const auto& [name, value] : more) replaced = replaced || text.starts_with(name + "=");
    if (!replaced) out.push_back(text);
  }
  for (const auto& [name, value] : more) out.push_back(name + "=" + value);
  return out;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> out;
  for (std::string& text : texts) out.push_back(text.data());
  out.push_back(nullptr);
  return out;
}

std::string read_all(int end) {
  std::string out;
  char bytes[4096];
  while (true) {
    const ::ssize_t n = ::read(end, bytes, sizeof(bytes));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return out;
    out.append(bytes, static_cast<std::size_t>(n));
  }
}

}  // namespace

Finished run_process(const std::vector<std::string>& words, const std::string& in,
                     const std::vector<std::pair<std::string, std::string>>& more) {
  if (in.size() > most_input) throw std::runtime_error(fmt::format("{} bytes for {}", in.size(), words[0]));
  Pipe to, from;
  std::vector<std::string> arguments = words, environment = environment_with(more);
  posix_spawn_file_actions_t streams;
  ::posix_spawn_file_actions_init(&streams);
  ::posix_spawn_file_actions_adddup2(&streams, to.read_end(), STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&streams, from.write_end(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&streams, from.write_end(), STDERR_FILENO);
  ::pid_t child = 0;
  const int error = ::posix_spawn(&child, words[0].c_str(), &streams, nullptr, pointers(arguments).data(),
                                  pointers(environment).data());
  ::posix_spawn_file_actions_destroy(&streams);
  if (error != 0) throw std::runtime_error(fmt::format("{}: {}", words[0], std::strerror(error)));
  // while the read end is open here, a child that reads nothing costs no signal
  [[maybe_unused]] const ::ssize_t written = ::write(to.write_end(), in.data(), in.size());
  to.close_write();
  from.close_write();
  Finished out;
  out.out = read_all(from.read_end());
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  out.code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return out;
}

}  // namespace bb
