# Writes OUTPUT, a header with the version, the commit and the compiler, if its contents change.
execute_process(COMMAND git -C ${SOURCE_DIR} rev-parse --short=12 HEAD
                OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE
                ERROR_QUIET RESULT_VARIABLE NO_GIT)
if(NO_GIT)
  set(COMMIT "unknown")
  set(DIRTY "unknown")
else()
  # Recorded results do not change what is measured.
  execute_process(COMMAND git -C ${SOURCE_DIR} status --porcelain --untracked-files=no
                          -- CMakeLists.txt core benchmarks
                  OUTPUT_VARIABLE CHANGES ERROR_QUIET)
  if(CHANGES STREQUAL "")
    set(DIRTY "no")
  else()
    set(DIRTY "yes")
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[// Written by build_info.cmake.
#pragma once

namespace isosyrk::build_info {
inline constexpr const char* version = "@VERSION@";
inline constexpr const char* commit = "@COMMIT@";
inline constexpr const char* dirty = "@DIRTY@";
inline constexpr const char* compiler = "@COMPILER@";
inline constexpr const char* flags = "@FLAGS@";
inline constexpr const char* build_type = "@BUILD_TYPE@";
}  // namespace isosyrk::build_info
]] @ONLY)
