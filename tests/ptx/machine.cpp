#include "tests/ptx/machine.hpp"

#include <cxxabi.h>

#include <algorithm>
#include <cfenv>
#include <cstdlib>
#include <numeric>

#include "tests/ptx/machine_state.hpp"

namespace ptx {

namespace {
std::vector<Module>& registered() {
  static std::vector<Module> all;
  return all;
}
}  // namespace

Registration::Registration(const Module& module) { registered().push_back(module); }
const std::vector<Module>& modules() { return registered(); }

int chosen_fault(const char* module) {
  const char* text = std::getenv("BB_PTX_FAULT");
  const std::string name = std::string(module) + ":";
  return text && std::string_view(text).starts_with(name) ? std::atoi(text + name.size()) : -1;
}

std::string demangled(const char* name) {
  int status = 0;
  char* text = abi::__cxa_demangle(name, nullptr, nullptr, &status);
  std::string out = text ? text : name;
  std::free(text);
  return out;
}

const Kernel* find_kernel(std::string_view mangled) {
  for (const Module& module : modules()) {
    for (const Kernel& kernel : module.kernels) {
      if (kernel.run && mangled == kernel.name) return &kernel;
    }
  }
  return nullptr;
}

namespace {
/// "void f<(E)2>" of "void f<(E)2>(long)".
std::string without_parameters(const std::string& name) {
  int depth = 0;
  for (std::size_t i = 0; i < name.size(); ++i) {
    depth += (name[i] == '<') - (name[i] == '>');
    if (name[i] == '(' && depth == 0) return name.substr(0, i);
  }
  return name;
}
}  // namespace

const Kernel* find_instance(std::string_view wrapper, std::string_view type) {
  static const std::map<std::string, const Kernel*> by_name = [] {
    std::map<std::string, const Kernel*> out;
    for (const Module& module : modules()) {
      for (const Kernel& kernel : module.kernels) {
        if (kernel.run) out.emplace(without_parameters(demangled(kernel.name)), &kernel);
      }
    }
    return out;
  }();
  std::string key = "void bb::exec::" + std::string(wrapper) + "<" + std::string(type);
  key += key.back() == '>' ? " >" : ">";
  const auto it = by_name.find(key);
  return it == by_name.end() ? nullptr : it->second;
}

namespace {
Coverage count(const Module& module, std::size_t begin, std::size_t end) {
  Coverage out;
  for (std::size_t b = begin; b < end; ++b) {
    const auto n = static_cast<std::size_t>(module.blocks[b].instructions);
    out.all += n;
    if (module.executed[b]) out.executed += n;
  }
  return out;
}
}  // namespace
Coverage coverage(const Module& module) { return count(module, 0, module.blocks.size()); }
Coverage coverage(const Module& module, const Kernel& kernel) {
  return count(module, kernel.first_block, kernel.first_block + kernel.n_blocks);
}

Machine::Machine() : all(std::make_unique<Implementation>()) {
  for (const Module& module : modules()) {
    for (const Constant& table : module.constants) {
      const auto begin = reinterpret_cast<std::uint64_t>(table.begin);
      all->memory.add(begin, begin + table.bytes, "constants", false);
    }
  }
}
Machine::~Machine() = default;

void Machine::add_memory(const void* p, std::size_t bytes, const std::string& name) {
  const auto begin = reinterpret_cast<std::uint64_t>(p);
  if (bytes > 0) all->memory.add(begin, begin + bytes, name, true);
}
void Machine::remove_memory(const void* p) { all->memory.remove(reinterpret_cast<std::uint64_t>(p)); }

void Machine::launch(const Kernel& kernel, const void* params, std::size_t bytes, std::uint32_t blocks,
                     std::uint32_t threads, Order order, std::mt19937_64& random) {
  if (bytes != kernel.param_bytes) {
    throw Error(demangled(kernel.name) + ": " + std::to_string(bytes) + " bytes of parameters, its PTX has " +
                std::to_string(kernel.param_bytes));
  }
  all->begin(*this, kernel, static_cast<const unsigned char*>(params), blocks, threads);
  std::vector<std::uint32_t> of_blocks(blocks), of_threads(threads);
  std::iota(of_blocks.begin(), of_blocks.end(), 0u), std::iota(of_threads.begin(), of_threads.end(), 0u);
  if (order == Order::reverse) std::reverse(of_blocks.begin(), of_blocks.end());
  if (order == Order::reverse) std::reverse(of_threads.begin(), of_threads.end());
  if (order == Order::shuffled) std::shuffle(of_blocks.begin(), of_blocks.end(), random);
  for (const std::uint32_t b : of_blocks) {
    if (order == Order::shuffled) std::shuffle(of_threads.begin(), of_threads.end(), random);
    all->run_block(b, of_threads);
    if (profile) all->count_traffic(traffic[kernel.name]);
  }
}

// --- other directions of rounding: behind a call that the compiler does not look into
namespace {
template <class T, class F>
[[gnu::noinline]] T directed(int direction, const F& f) {
  const int before = std::fegetround();
  std::fesetround(direction);
  const volatile T result = f();
  std::fesetround(before);
  return result;
}
}  // namespace
template <class T>
T add_directed(T a, T b, int direction) {
  const volatile T x = a, y = b;
  return directed<T>(direction, [&] { return x + y; });
}
template <class T>
T mul_directed(T a, T b, int direction) {
  const volatile T x = a, y = b;
  return directed<T>(direction, [&] { return x * y; });
}
template <class T>
T fma_directed(T a, T b, T c, int direction) {
  const volatile T x = a, y = b, z = c;
  return directed<T>(direction, [&] { return std::fma(x, y, z); });
}
template double add_directed(double, double, int);
template float add_directed(float, float, int);
template double mul_directed(double, double, int);
template float mul_directed(float, float, int);
template double fma_directed(double, double, double, int);
template float fma_directed(float, float, float, int);
double to_double_directed(std::int64_t a, int direction) {
  const volatile std::int64_t x = a;
  return directed<double>(direction, [&] { return static_cast<double>(x); });
}

}  // namespace ptx
