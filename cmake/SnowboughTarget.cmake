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

# Functions compiled for AVX-512 (base/simd.h) use its whole registers: compilers prefer halves of them.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT APPLE)
  target_compile_options(snowbough_warnings INTERFACE -mprefer-vector-width=512)
endif()

# Batches of files compile together: reading the headers takes half of a file's time. Names in the anonymous namespaces
# of one library must therefore differ. The preset `dev` switches it off, so that one changed file compiles alone.
option(SNOWBOUGH_UNITY "Compile several sources of a library together" ON)

# snowbough_library(NAME SOURCES... ): a static library. Its headers are included as <folder>/<header>.h
function(snowbough_library name)
  add_library(${name} STATIC ${ARGN})
  target_include_directories(${name} PUBLIC "${CMAKE_SOURCE_DIR}/native")
  target_link_libraries(${name} PRIVATE snowbough_warnings)
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${SNOWBOUGH_UNITY} UNITY_BUILD_BATCH_SIZE 8)
endfunction()

# snowbough_room(NAME FOLDERS... ): the library of all sources in the folders.
function(snowbough_room name)
  list(TRANSFORM ARGN APPEND "/*.cpp")
  file(GLOB sources CONFIGURE_DEPENDS RELATIVE "${CMAKE_CURRENT_SOURCE_DIR}" ${ARGN})
  snowbough_library(${name} ${sources})
endfunction()
