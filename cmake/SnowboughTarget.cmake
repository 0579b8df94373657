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

# snowbough_library(NAME SOURCES... ): a static library. Its headers are included as <folder>/<header>.h
function(snowbough_library name)
  add_library(${name} STATIC ${ARGN})
  target_include_directories(${name} PUBLIC "${CMAKE_SOURCE_DIR}/native")
  target_link_libraries(${name} PRIVATE snowbough_warnings)
endfunction()
