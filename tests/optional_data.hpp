// Data that no clone has: tests that use it are skipped unless the environment says where it is.
#pragma once

#include <cstdlib>
#include <filesystem>

/// The folder `name` of BARRIERBENCH_DATA; a path where nothing is if the variable is not set.
inline std::filesystem::path optional_data(const char* name) {
  const char* folder = std::getenv("BARRIERBENCH_DATA");
  return std::filesystem::path(folder != nullptr ? folder : "/nowhere/BARRIERBENCH_DATA") / name;
}
