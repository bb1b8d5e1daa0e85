// What made a record: the program with its plugins and libraries, and the machine.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/record/field.hpp"

namespace bb {

using TextMap = std::map<std::string, std::string>;

struct PluginFile {
  BB_RECORD(PluginFile, "a plugin that was loaded");
  BB_FIELD(std::string, name, "that it gives itself");
  BB_FIELD(std::string, file, "relative to the folder of this record");
  BB_FIELD(std::string, sha256, "of the file", "^[0-9a-f]{64}$");
  BB_RECORD_END;
};

struct BlasRecord {
  BB_RECORD(BlasRecord, "the BLAS behind the factorisations: another kernel gives other bits");
  BB_FIELD(std::string, kernel, "of OpenBLAS, the one that ran: Haswell, SkylakeX");
  BB_FIELD(std::string, requested, "OPENBLAS_CORETYPE; native: OpenBLAS chose by the processor");
  BB_FIELD(std::string, config, "openblas_get_config()");
  BB_FIELD(std::string, library, "file that holds dgemm");
  BB_FIELD(int, threads, "of BLAS") = 1;
  BB_RECORD_END;
};

struct Provenance {
  BB_RECORD(Provenance, "the program that made the record");
  BB_FIELD(std::string, tool_version, "of barrierbench");
  BB_FIELD(std::string, git_commit, "of the tree that was built");
  BB_FIELD(bool, git_dirty, "whether files differed from it") = false;
  BB_FIELD(std::string, compiler, "name and version");
  BB_FIELD(std::string, flags, "that decide the generated code");
  BB_FIELD(std::string, build_type, "of CMake");
  BB_FIELD(bool, fast_math, "whether the compiler could reorder sums") = false;
  BB_FIELD(std::string, fp_contract, "whether it fused multiply and add");
  BB_FIELD(TextMap, libraries, "name -> version");
  BB_FIELD(std::vector<PluginFile>, plugins, "every plugin that was loaded");
  BB_FIELD(std::vector<std::string>, argv, "the command");
  BB_FIELD(TextMap, env, "variables of thread counts and the like");
  BB_FIELD(int, threads, "of the program") = 1;
  BB_FIELD(BlasRecord, blas, "linear algebra of dense blocks");
  BB_RECORD_END;
};

struct Machine {
  BB_RECORD(Machine, "where it ran");
  BB_FIELD(std::string, cpu_model, "of /proc/cpuinfo");
  BB_FIELD(int, cores, "online") = 0;
  BB_FIELD(std::string, governor, "of the clock; empty: unknown");
  using Load = std::array<double, 3>;
  BB_FIELD(Load, load_avg, "of 1, 5 and 15 minutes at the start") = {0, 0, 0};
  BB_FIELD(std::uint64_t, mem_bytes, "physical memory") = 0;
  BB_FIELD(std::string, os, "of /etc/os-release");
  BB_FIELD(std::string, kernel, "of the system");
  BB_FIELD(bool, virtualised, "whether a hypervisor is below") = false;
  BB_FIELD(std::optional<std::string>, card, "graphics card that took part, its driver; absent: none did");
  BB_RECORD_END;
};

}  // namespace bb
