# bb_read_registry(FILE OUT): the names of a registry.inc, whose only lines are ENTRY(name, "doc") or PART(name, "doc"), with more words,
# texts, true or false behind the doc, #include "..." of another registry, comments and blanks. C++ includes the same file; a new
# line re-runs the configuration.
function(bb_read_registry file out)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
  file(STRINGS "${file}" lines)
  set(names "")
  foreach(line IN LISTS lines)
    if(line MATCHES "^(ENTRY|PART|LAGGED)\\(([a-z][a-z0-9_]*), \"[^\"]*\"(, ([a-z][a-z0-9_]*|\"[^\"]*\"))*\\)$")
      list(APPEND names "${CMAKE_MATCH_2}")
    elseif(NOT line MATCHES "^ *(//.*)?$" AND NOT line MATCHES "^#include \"[^\"]*\"$")
      message(FATAL_ERROR "${file}: '${line}' is not ENTRY(name, \"doc\")")
    endif()
  endforeach()
  set(${out} "${names}" PARENT_SCOPE)
endfunction()
