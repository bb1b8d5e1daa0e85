# Run at every build: writes OUTPUT from INPUT when something changed (commit, dirty flag, flags), so that only
# this one small file is compiled again.
find_package(Git QUIET)
set(GIT_COMMIT "")
set(GIT_DIRTY false)
if(GIT_FOUND)
  execute_process(COMMAND "${GIT_EXECUTABLE}" -C "${SOURCE_DIR}" rev-parse HEAD
    OUTPUT_VARIABLE GIT_COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND "${GIT_EXECUTABLE}" -C "${SOURCE_DIR}" status --porcelain --untracked-files=no
    OUTPUT_VARIABLE changes ERROR_QUIET)
  if(changes)
    set(GIT_DIRTY true)
  endif()
endif()
configure_file("${INPUT}" "${OUTPUT}" @ONLY)
