# Eigen without indexed views and reshaped expressions (m(seq(0, 3), all), m.reshaped()), which no code here uses: every type of an
# expression carries their declarations, and every m(i, j) chooses among their overloads; together a fifth of g++'s time for element
# functions. The folder `eigen` of the build has a link to each file of the installed one, and an empty file in place of those
# members. Nothing else is changed, and no generated code.
function(bb_lean_eigen)
  set(lean "${PROJECT_BINARY_DIR}/eigen")
  set(left_out Eigen/src/plugins/IndexedViewMethods.h Eigen/src/plugins/ReshapedMethods.h)
  get_target_property(installed Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
  file(GLOB_RECURSE files LIST_DIRECTORIES FALSE RELATIVE "${installed}" "${installed}/Eigen/*")
  foreach(file IN LISTS files)
    if(EXISTS "${lean}/${file}")
      continue()
    endif()
    cmake_path(GET file PARENT_PATH folder)
    file(MAKE_DIRECTORY "${lean}/${folder}")
    if(file IN_LIST left_out)
      file(WRITE "${lean}/${file}" "// Left out: cmake/LeanEigen.cmake.\n")
    else()
      file(CREATE_LINK "${installed}/${file}" "${lean}/${file}" SYMBOLIC)
    endif()
  endforeach()
  set_target_properties(Eigen3::Eigen PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${lean}")
endfunction()
bb_lean_eigen()
