#include "tests/ptx/report.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace ptx {

namespace {
std::map<std::string, TrafficOfBuffers>& all_traffic() {
  static std::map<std::string, TrafficOfBuffers> all;
  return all;
}

double share(const Coverage& c) {
  return c.all == 0 ? 1 : static_cast<double>(c.executed) / static_cast<double>(c.all);
}

void print_kernel(const Module& module, const Kernel& kernel) {
  const Coverage c = coverage(module, kernel);
  std::printf("  %5.1f %% of %zu: %s\n        not run: lines", 100 * share(c), c.all,
              demangled(kernel.name).c_str());
  int shown = 0;
  for (std::size_t b = kernel.first_block; b < kernel.first_block + kernel.n_blocks && shown < 12; ++b) {
    if (module.executed[b]) continue;
    std::printf(" %d", module.blocks[b].line), ++shown;
  }
  std::printf("%s\n", shown == 12 ? " ..." : "");
}
}  // namespace

void write_profile() {
  const char* path = std::getenv("BB_PTX_PROFILE");
  if (!path) return;
  std::ofstream out(path);
  out << "{\n  \"kernels\": [";
  const char* separator = "\n";
  for (const Module& module : modules()) {
    for (const Kernel& kernel : module.kernels) {
      const Coverage c = coverage(module, kernel);
      out << separator << "    {\"module\": \"" << module.name << "\", \"name\": \"" << kernel.name
          << "\", \"instructions\": " << c.all << ", \"executed\": " << c.executed << ", \"buffers\": {";
      const char* between = "";
      for (const auto& [buffer, t] : all_traffic()[kernel.name]) {
        out << between << "\"" << buffer << "\": {\"requests\": " << t.requests << ", \"lines\": " << t.lines
            << ", \"sectors\": " << t.sectors << ", \"least\": " << t.least << "}";
        between = ", ";
      }
      out << "}}";
      separator = ",\n";
    }
  }
  out << "\n  ]\n}\n";
}

bool profile_wanted() { return std::getenv("BB_PTX_PROFILE") != nullptr; }

void note_traffic(Machine& machine) {
  for (const auto& [name, buffers] : machine.traffic) {
    for (const auto& [buffer, t] : buffers) all_traffic()[name][buffer].add(t);
  }
  machine.traffic.clear();
}

namespace {
bool is_word(std::string_view word, std::string_view text) {
  return (" " + std::string(text) + " ").find(" " + std::string(word) + " ") != std::string::npos;
}
}  // namespace

bool report(double least, std::string_view judged) {
  std::size_t n_judged = 0;
  bool good = true;
  for (const Module& module : modules()) {
    const Coverage c = coverage(module);
    std::printf("PTX of %s: %zu of %zu instructions ran, %.1f %%\n", module.name, c.executed, c.all,
                100 * share(c));
    for (const Kernel& kernel : module.kernels) {
      if (share(coverage(module, kernel)) < least) print_kernel(module, kernel);
    }
    if (!is_word(module.name, judged)) continue;
    ++n_judged;
    good = good && c.all > 0 && share(c) >= least;
  }
  return good && n_judged > 0;
}

void list_faults() {
  for (const Module& module : modules()) {
    for (std::size_t i = 0; i < module.faults.size(); ++i) {
      const Fault& f = module.faults[i];
      std::printf("fault %s %zu %d %d %s; %s\n", module.name, i, int{module.executed[f.block]}, f.line,
                  f.kind, demangled(f.function).c_str());
    }
  }
}

}  // namespace ptx
