# Compile options of our own code. The development build treats warnings as errors; the bundled build disables them.
# Headers of other libraries are SYSTEM, which suppresses their warnings.
add_library(snowbough_warnings INTERFACE)
if(SNOWBOUGH_BUNDLED)
  target_compile_options(snowbough_warnings INTERFACE -w)
else()
  target_compile_options(snowbough_warnings INTERFACE -Wall -Wextra -Wpedantic -Werror)
endif()

# The same input must give bit-identical results, so the compiler must not choose fused multiply-add by itself.
target_compile_options(snowbough_warnings INTERFACE -ffp-contract=off)

# These let the compiler vectorise loops with floats; the results are the same without them.
target_compile_options(snowbough_warnings INTERFACE -fno-trapping-math -fno-math-errno)

# Functions compiled for AVX-512 (base/simd.h) use its whole registers: compilers prefer halves of them.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT APPLE)
  target_compile_options(snowbough_warnings INTERFACE -mprefer-vector-width=512)
endif()

# Batches of files compile together: reading the headers takes half of a file's time. Names in the anonymous namespaces
# of one library must therefore differ. The preset `dev` switches it off, so that one changed file compiles alone.
option(SNOWBOUGH_UNITY "Compile several sources of a library together" ON)

# The headers that most files read are compiled once. Not with a launcher, since ccache does not store what uses them, nor
# in builds of single files, which find headers that are missing.
set(SNOWBOUGH_HEADERS "")
if(SNOWBOUGH_UNITY AND CMAKE_BUILD_TYPE STREQUAL Release AND NOT SNOWBOUGH_BUNDLED AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(SNOWBOUGH_HEADERS <algorithm> <array> <cmath> <cstdint> <functional> <limits> <map> <memory> <mutex> <numeric>
    <optional> <span> <stdexcept> <string> <utility> <vector> <glm/common.hpp> <glm/geometric.hpp> <glm/mat3x3.hpp>
    <glm/mat4x4.hpp> <glm/vec2.hpp> <glm/vec3.hpp> <glm/vec4.hpp>)
endif()

# snowbough_library(NAME SOURCES... ): a static library. Its headers are included as <folder>/<header>.h
function(snowbough_library name)
  add_library(${name} STATIC ${ARGN})
  target_include_directories(${name} PUBLIC "${CMAKE_SOURCE_DIR}/native")
  target_link_libraries(${name} PRIVATE snowbough_warnings)
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${SNOWBOUGH_UNITY} UNITY_BUILD_BATCH_SIZE 8)
  # GCC 12 warns falsely of an uninitialised variable in tree/read if its headers are compiled before.
  if(SNOWBOUGH_HEADERS AND name STREQUAL snowbough_base)
    target_precompile_headers(${name} PRIVATE ${SNOWBOUGH_HEADERS})
  elseif(SNOWBOUGH_HEADERS AND NOT name STREQUAL snowbough_tree_read)
    target_precompile_headers(${name} REUSE_FROM snowbough_base)
  endif()
endfunction()

# snowbough_room(NAME FOLDERS... ): the library of all sources in the folders.
function(snowbough_room name)
  list(TRANSFORM ARGN APPEND "/*.cpp")
  file(GLOB sources CONFIGURE_DEPENDS RELATIVE "${CMAKE_CURRENT_SOURCE_DIR}" ${ARGN})
  snowbough_library(${name} ${sources})
endfunction()
