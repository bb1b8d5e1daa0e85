#include "core/model/plugin/library_file.hpp"

#include <elf.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>

#include "core/base/input/read_file.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

constexpr unsigned seconds_to_load = 10;
constexpr const char* whole_library = "a whole 64-bit ELF shared library";

/// True when `count` entries of `size` bytes from `offset` on lie within the file.
bool within(const std::string& bytes, std::uint64_t offset, std::uint64_t count, std::uint64_t size) {
  return offset <= bytes.size() && (size == 0 || count <= (bytes.size() - offset) / size);
}

template <class T>
T at(const std::string& bytes, std::uint64_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

/// What is wrong with the ELF headers; empty when nothing is.
std::string elf_fault(const std::string& bytes) {
  if (!within(bytes, 0, 1, sizeof(Elf64_Ehdr)) || bytes.compare(0, SELFMAG, ELFMAG) != 0)
    return "no ELF header";
  const auto header = at<Elf64_Ehdr>(bytes, 0);
  if (header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_type != ET_DYN) return "an ELF file of another kind";
  if (header.e_phnum == 0 || header.e_phentsize != sizeof(Elf64_Phdr)) return "no program headers";
  if (!within(bytes, header.e_phoff, header.e_phnum, sizeof(Elf64_Phdr)))
    return "program headers beyond its end";
  for (std::uint64_t i = 0; i < header.e_phnum; ++i) {
    const auto segment = at<Elf64_Phdr>(bytes, header.e_phoff + i * sizeof(Elf64_Phdr));
    if (!within(bytes, segment.p_offset, segment.p_filesz, 1))
      return fmt::format("segment {} beyond its end", i);
  }
  if (!within(bytes, header.e_shoff, header.e_shnum, header.e_shentsize))
    return "a section table beyond its end";
  return {};
}

void silence() {
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(null, fd);
}

/// Never returns. `done` gets one byte once `load` came to an end.
[[noreturn]] void load_and_leave(const std::function<void()>& load, int done) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGALRM}) std::signal(number, SIG_DFL);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  silence();
  ::alarm(seconds_to_load);
  try {
    load();
  } catch (...) {  // NOLINT(bugprone-empty-catch): thrown again where it can be reported
  }
  const char byte = 1;
  const bool told = ::write(done, &byte, 1) == 1;
  ::_exit(told ? 0 : 1);
}

std::string ending_of(int status) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
    return fmt::format("no end within {} s", seconds_to_load);
  if (WIFSIGNALED(status))
    return fmt::format("signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)));
  return fmt::format("exit({})", WEXITSTATUS(status));
}

}  // namespace

void check_library_bytes(const std::string& bytes, const std::string& file) {
  const std::string fault = elf_fault(bytes);
  if (!fault.empty()) throw ConfigError(file, fault, whole_library);
}

void check_library_file(const std::string& file) {
  check_library_bytes(read_input_file(file, plugin_file), file);
}

void try_in_child(const std::string& file, const std::function<void()>& load) {
  const auto give_up = [&](const char* what) {
    throw std::runtime_error(fmt::format("{}: {}: {}", file, what, std::strerror(errno)));
  };
  int done[2];
  if (::pipe2(done, O_CLOEXEC) != 0) give_up("no pipe");
  const ::pid_t child = ::fork();
  if (child < 0) give_up("no child process");
  if (child == 0) load_and_leave(load, done[1]);
  ::close(done[1]);
  char byte = 0;
  ::ssize_t told = 0;
  do {
    told = ::read(done[0], &byte, 1);
  } while (told < 0 && errno == EINTR);
  ::close(done[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (told == 1) return;
  throw ConfigError(
      file, fmt::format("{} while the library was loaded and its entries were read", ending_of(status)),
      "a library that loads");
}

}  // namespace bb
