#include "experiments/cli/say.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

#include "core/base/input/names.hpp"

namespace bb::cli {

namespace {

void write_out(std::string_view text) {
  struct sigaction ignore {
  }, before{};
  ignore.sa_handler = SIG_IGN;
  ::sigaction(SIGPIPE, &ignore, &before);
  while (!text.empty()) {
    const ::ssize_t n = ::write(STDERR_FILENO, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  ::sigaction(SIGPIPE, &before, nullptr);
}

}  // namespace

void say(std::string_view text) { write_out(printable(text)); }

void show_text(std::string_view text) { fmt::print("{}", printable(text)); }

void rewrite_line(std::string_view text) { write_out("\r\033[K" + printable(text)); }

void prepare_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    // open() takes the lowest free number, which is this one; the wrong direction keeps every use an error
    const int mode = descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY;
    if (::open("/dev/null", mode) < 0) return;
  }
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace bb::cli
