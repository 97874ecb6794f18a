# One folder, one library target: scansion_library(NAME SOURCES ... DEPS ... [PRIVATE_DEPS ...])
add_library(scansion_options INTERFACE)
target_include_directories(scansion_options INTERFACE ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/generated)
# No fused multiply-add: distances are bit-identical on every machine.
target_compile_options(scansion_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual
  -ffp-contract=off -fno-math-errno)
if(SCANSION_WERROR)
  target_compile_options(scansion_options INTERFACE -Werror)
endif()
if(SCANSION_SANITIZE)
  target_compile_options(scansion_options INTERFACE -fsanitize=${SCANSION_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(scansion_options INTERFACE -fsanitize=${SCANSION_SANITIZE})
endif()
target_link_libraries(scansion_options INTERFACE Threads::Threads)

set(SCANSION_PCH <algorithm> <array> <cstdint> <cstring> <functional> <memory> <optional> <span> <string> <string_view> <utility>
    <variant> <vector> <boost/outcome/basic_result.hpp> <boost/outcome/policy/terminate.hpp> <boost/outcome/try.hpp>)

function(scansion_library NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS;PRIVATE_DEPS" ${ARGN})
  add_library(${NAME} STATIC ${ARG_SOURCES})
  target_link_libraries(${NAME} PUBLIC scansion_options ${ARG_DEPS} PRIVATE ${ARG_PRIVATE_DEPS})
  target_precompile_headers(${NAME} PRIVATE ${SCANSION_PCH})
endfunction()

# A test program of GoogleTest cases: scansion_test(NAME LABEL unit SOURCES ... DEPS ...)
function(scansion_test NAME)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;DEPS" ${ARGN})
  add_executable(${NAME} ${ARG_SOURCES})
  target_link_libraries(${NAME} PRIVATE scansion_options ${ARG_DEPS} GTest::gtest_main)
  target_precompile_headers(${NAME} PRIVATE ${SCANSION_PCH} <gtest/gtest.h>)
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  add_test(NAME ${NAME} COMMAND ${NAME})
  set_tests_properties(${NAME} PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
endfunction()
