// Runs translated kernels on the CPU: which there are, what memory they may touch, launches, what was executed.
#pragma once

#include <map>
#include <memory>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tests/ptx/runtime.hpp"

namespace ptx {

/// What a kernel must not do. what() names the kernel and the line of its PTX.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Straight-line code: how many instructions from a line of the PTX on.
struct CodeBlock {
  int line, instructions;
};

/// An entry or a device function that is called.
struct Kernel {
  const char* name;      // mangled
  void (*run)(Thread&);  // null for a device function
  std::uint32_t param_bytes, shared_bytes;
  bool synchronizes;  // has barriers or shuffles
  struct Parameter {
    std::uint32_t offset, bytes;
  };
  std::span<const Parameter> params;
  std::size_t first_block, n_blocks;  // of the module
};

/// Tables that kernels read.
struct Constant {
  const void* begin;
  std::size_t bytes;
};

/// An instruction that can be broken (translate.py --faults).
struct Fault {
  const char* kind;
  int line;
  std::size_t block;  // where it is
  const char* function;
};

/// What was translated from one file.
struct Module {
  const char* name;
  std::span<const Kernel> kernels;
  std::span<const CodeBlock> blocks;
  unsigned char* executed;  // one a block, 1 when it ran
  std::span<const Constant> constants;
  std::span<const Fault> faults;
};

/// Modules register themselves before main.
struct Registration {
  explicit Registration(const Module& module);
};
const std::vector<Module>& modules();
/// The number in the environment's BB_PTX_FAULT=MODULE:NUMBER, -1 where it names another module or is not set.
int chosen_fault(const char* module);

/// By mangled name; null when there is none.
const Kernel* find_kernel(std::string_view mangled);
/// "run_each", "bb::exec::SpmvDot": the instance of bb::exec's template; null when there is none.
const Kernel* find_instance(std::string_view wrapper, std::string_view type);

enum class Order { forward, reverse, shuffled };

/// The memory traffic of the warps of a kernel: requests, 128 B lines and 32 B sectors that they touch, and how many sectors
/// the bytes of each request would fill if they lay side by side.
struct Traffic {
  std::uint64_t requests = 0, lines = 0, sectors = 0, least = 0;
  void add(const Traffic& more) {
    requests += more.requests, lines += more.lines, sectors += more.sectors, least += more.least;
  }
};
using TrafficOfBuffers = std::map<std::string, Traffic>;

/// Runs blocks one after another, the threads of a block as fibers. One launch at a time.
struct Machine {
  Machine();
  ~Machine();
  Machine(const Machine&) = delete;

  /// What kernels may touch; name: of the buffer, in `traffic`.
  void add_memory(const void* p, std::size_t bytes, const std::string& name = "");
  void remove_memory(const void* p);

  /// params: as the parameters lie in `kernel.params`. Errors: Error.
  void launch(const Kernel& kernel, const void* params, std::size_t bytes, std::uint32_t blocks,
              std::uint32_t threads, Order order, std::mt19937_64& random);

  bool profile = false;
  std::map<std::string, TrafficOfBuffers> traffic;  // by mangled name

  struct Implementation;
  std::unique_ptr<Implementation> all;
};

/// Instructions of a module or kernel that ran.
struct Coverage {
  std::size_t executed = 0, all = 0;
};
Coverage coverage(const Module& module);
Coverage coverage(const Module& module, const Kernel& kernel);
std::string demangled(const char* name);

}  // namespace ptx
