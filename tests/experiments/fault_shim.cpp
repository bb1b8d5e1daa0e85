// A library that the tests load in front of the program (LD_PRELOAD): it kills the process at one of the calls by which
// files change, or says of a factorisation that its factor is too large. Environment:
//   FAULT_AT      kill the process in the place of the n-th such call, n from 1; of a write half of it is done
//   FAULT_COUNT   a file that gets the number of these calls when the process ends by itself
//   FAULT_CHOLMOD anything: every factorisation fails with CHOLMOD_TOO_LARGE
#include <cholmod.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace {

long calls = 0;

long wanted() {
  const char* const at = std::getenv("FAULT_AT");
  return at ? std::atol(at) : 0;
}

void die() {
  ::kill(::getpid(), SIGKILL);
  for (;;) ::pause();
}

/// Whether this call is the one.
bool count() {
  static const long at = wanted();
  return ++calls == at;
}

template <class F>
F next(F, const char* name) {
  return reinterpret_cast<F>(::dlsym(RTLD_NEXT, name));
}

bool is_a_file(int fd) {
  struct stat of {};
  return fd > 2 && ::fstat(fd, &of) == 0 && S_ISREG(of.st_mode);
}

__attribute__((destructor)) void say_count() {
  const char* const path = std::getenv("FAULT_COUNT");
  if (path == nullptr) return;
  if (std::FILE* const file = std::fopen(path, "w")) {
    std::fprintf(file, "%ld\n", calls);
    std::fclose(file);
  }
}

}  // namespace

extern "C" {

#define BB_COUNTED(type, name, parameters, arguments)                               \
  type name parameters noexcept {                                                   \
    static const auto real = next(static_cast<type(*) parameters>(nullptr), #name); \
    if (count()) die();                                                             \
    return real arguments;                                                          \
  }
BB_COUNTED(int, rename, (const char* from, const char* to), (from, to))
BB_COUNTED(int, remove, (const char* path), (path))
BB_COUNTED(int, unlink, (const char* path), (path))
BB_COUNTED(int, rmdir, (const char* path), (path))
BB_COUNTED(int, mkdir, (const char* path, mode_t mode), (path, mode))
BB_COUNTED(int, ftruncate, (int fd, off_t size), (fd, size))
BB_COUNTED(int, truncate, (const char* path, off_t size), (path, size))
#undef BB_COUNTED

int fsync(int fd) {
  static const auto real = next(static_cast<int (*)(int)>(nullptr), "fsync");
  if (count()) die();
  return real(fd);
}

ssize_t write(int fd, const void* data, size_t size) {
  static const auto real = next(static_cast<ssize_t (*)(int, const void*, size_t)>(nullptr), "write");
  if (is_a_file(fd) && count()) {
    static_cast<void>(real(fd, data, size / 2));
    die();
  }
  return real(fd, data, size);
}

ssize_t pwrite(int fd, const void* data, size_t size, off_t at) {
  static const auto real = next(static_cast<ssize_t (*)(int, const void*, size_t, off_t)>(nullptr), "pwrite");
  if (is_a_file(fd) && count()) {
    static_cast<void>(real(fd, data, size / 2, at));
    die();
  }
  return real(fd, data, size, at);
}

int cholmod_factorize(cholmod_sparse* a, cholmod_factor* factor, cholmod_common* common) {
  static const auto real = next(
      static_cast<int (*)(cholmod_sparse*, cholmod_factor*, cholmod_common*)>(nullptr), "cholmod_factorize");
  if (std::getenv("FAULT_CHOLMOD") == nullptr) return real(a, factor, common);
  common->status = CHOLMOD_TOO_LARGE;
  return 0;
}
}
