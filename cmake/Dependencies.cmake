# Every library we use, from Debian's packages. Imported targets are SYSTEM includes, so their warnings stay theirs.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
include(LeanEigen)
find_package(CHOLMOD 3 REQUIRED)
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(CLI11 REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(muparser REQUIRED)  # weights as formulas
find_package(pugixml REQUIRED)   # VTU, VTP
find_package(ZLIB REQUIRED)      # and what they compress

find_path(SPECTRA_INCLUDE_DIR Spectra/SymEigsSolver.h REQUIRED)
find_path(METIS_INCLUDE_DIR metis.h REQUIRED)
find_library(METIS_LIBRARY metis REQUIRED)
find_path(GMP_INCLUDE_DIR gmpxx.h REQUIRED)
find_library(GMP_LIBRARY gmp REQUIRED)
find_library(GMPXX_LIBRARY gmpxx REQUIRED)

function(bb_import name include)
  add_library(bb::${name} INTERFACE IMPORTED GLOBAL)
  set_target_properties(bb::${name} PROPERTIES INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${include}"
    INTERFACE_LINK_LIBRARIES "${ARGN}")
endfunction()
bb_import(spectra "${SPECTRA_INCLUDE_DIR}" Eigen3::Eigen)
bb_import(metis "${METIS_INCLUDE_DIR}" "${METIS_LIBRARY}")
bb_import(gmp "${GMP_INCLUDE_DIR}" "${GMPXX_LIBRARY}" "${GMP_LIBRARY}")

if(BB_TESTS)
  find_package(GTest REQUIRED)
  include(GoogleTest)
endif()
if(BB_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()
