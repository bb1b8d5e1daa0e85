// Build, machine and ids of a record, read from the generated build info, /proc and the environment.
#include "core/base/record/provenance.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/record/build_info.hpp"
#include "core/base/record/kept_hash.hpp"
#include "core/base/record/program_file.hpp"
#include "core/linear/blas_info.hpp"

namespace bb {
namespace {

std::string first_line(const char* path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  return line;
}

/// Value of the first line of `path` that starts with `key`, after the separator.
std::string value_of(const char* path, std::string_view key, char separator) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t at = line.find(separator);
    if (at == std::string::npos) continue;
    const std::size_t start = line.find_first_not_of(" \t\"", at + 1);
    if (start == std::string::npos) return {};
    return line.substr(start, line.find_last_not_of(" \t\"") + 1 - start);
  }
  return {};
}

BlasRecord blas_record() {
  const BlasInfo info = blas_info();
  return {info.kernel, info.requested, info.config, info.dgemm_library, info.threads};
}

bool kept_variable(std::string_view name) {
  for (std::string_view prefix : {"OMP_", "OPENBLAS_", "MKL_", "TBB_", "GOTO_", "BARRIERBENCH_", "BB_"}) {
    if (name.starts_with(prefix)) return true;
  }
  return name == "LD_PRELOAD" || name == "LC_ALL";
}

}  // namespace

Provenance collect_provenance(std::vector<std::string> argv, int threads) {
  Provenance p;
  p.tool_version = kBuildInfo.version;
  p.git_commit = kBuildInfo.git_commit;
  p.git_dirty = kBuildInfo.git_dirty;
  p.compiler = kBuildInfo.compiler;
  p.flags = kBuildInfo.flags;
  p.build_type = kBuildInfo.build_type;
#ifdef __FAST_MATH__
  p.fast_math = true;
#endif
  p.fp_contract = "off";
  p.blas = blas_record();
  p.libraries = {{"eigen", std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) +
                               "." + std::to_string(EIGEN_MINOR_VERSION)},
                 {"cholmod", kBuildInfo.cholmod},
                 {"blas", p.blas.config + " at " + p.blas.library},
                 {"tbb", kBuildInfo.tbb},
                 {"fmt", kBuildInfo.fmt}};
  p.argv = std::move(argv);
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    const std::string_view text(*entry);
    const std::size_t at = text.find('=');
    if (at != std::string_view::npos && kept_variable(text.substr(0, at))) {
      p.env.emplace(text.substr(0, at), text.substr(at + 1));
    }
  }
  p.threads = threads;
  return p;
}

Machine collect_machine() {
  Machine m;
  m.cpu_model = value_of("/proc/cpuinfo", "model name", ':');
  m.governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  m.os = value_of("/etc/os-release", "PRETTY_NAME", '=');
  m.cores = static_cast<int>(::sysconf(_SC_NPROCESSORS_ONLN));
  m.mem_bytes = std::strtoull(value_of("/proc/meminfo", "MemTotal", ':').c_str(), nullptr, 10) * 1024;
  m.virtualised = value_of("/proc/cpuinfo", "flags", ':').find(" hypervisor") != std::string::npos;
  if (::getloadavg(m.load_avg.data(), 3) != 3) m.load_avg = {};
  utsname name{};
  if (::uname(&name) == 0) m.kernel = std::string(name.sysname) + " " + name.release + " " + name.machine;
  return m;
}

// The list of the loader names every library by its path, and the program itself by nothing.
std::string program_file() {
  Dl_info info{};
  void* map = nullptr;
  const void* here = reinterpret_cast<const void*>(&program_file);
  if (::dladdr1(here, &info, &map, RTLD_DL_LINKMAP) == 0 || map == nullptr) return "/proc/self/exe";
  const char* name = static_cast<const link_map*>(map)->l_name;
  return name != nullptr && *name != 0 ? name : "/proc/self/exe";
}

void fill_ids(RunRecord& record) {
  static const std::string this_program = kept_sha256(program_file(), hashes_folder());
  Ids& ids = record.ids;
  ids.config_id = config_id(record.config.text);
  ids.build_id = this_program;
  const std::string card = record.machine.card ? "\n" + *record.machine.card : "";
  ids.machine_id = sha256_hex(record.machine.cpu_model + "\n" + std::to_string(record.machine.cores) + "\n" +
                              record.machine.kernel + card);
  std::string parts = ids.config_id + "\n" + ids.build_id + "\n" + ids.machine_id + "\n" +
                      std::to_string(record.provenance.threads) + "\n";
  for (const auto& [name, version] : record.provenance.libraries)
    parts += fmt::format("{} {}\n", name, version);
  parts += "BLAS kernel " + record.provenance.blas.kernel + "\n";
  std::vector<std::string> plugins;  // the order of --plugin means nothing
  for (const PluginFile& plugin : record.provenance.plugins) plugins.push_back(plugin.sha256 + "\n");
  std::sort(plugins.begin(), plugins.end());
  for (const std::string& plugin : plugins) parts += plugin;
  ids.run_id = sha256_hex(parts);
}

std::uint64_t peak_rss_bytes() {
  rusage usage{};
  if (::getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::string utc_now() {
  timespec now{};
  std::timespec_get(&now, TIME_UTC);
  std::tm parts{};
  ::gmtime_r(&now.tv_sec, &parts);
  char text[32];
  const std::size_t n = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &parts);
  std::string milliseconds = std::to_string(1000 + now.tv_nsec / 1000000);  // padded by its leading 1
  return std::string(text, n) + "." + milliseconds.substr(1) + "Z";
}

std::optional<double> seconds_of_utc(const std::string& text) {
  std::tm parts{};
  const char* rest = ::strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &parts);
  if (rest == nullptr) return {};
  return static_cast<double>(::timegm(&parts)) + (*rest == '.' ? std::strtod(rest, nullptr) : 0);
}

}  // namespace bb
