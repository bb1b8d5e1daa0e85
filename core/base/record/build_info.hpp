// What the configuration and the build baked into this binary; build_info.cpp
// is generated (build_info.cmake).
#pragma once

namespace bb {

struct BuildInfo {
  const char* version;
  const char* git_commit;
  bool git_dirty;
  const char* compiler;
  const char* flags;
  const char* build_type;
  const char* cholmod;
  const char* tbb;
  const char* fmt;
};
extern const BuildInfo kBuildInfo;

}  // namespace bb
