# Our own code compiles without warnings; other people's headers are SYSTEM and are left alone.
add_library(snowbough_warnings INTERFACE)
# The development build looks at them.
if(SNOWBOUGH_BUNDLED)
  target_compile_options(snowbough_warnings INTERFACE -w)
else()
  target_compile_options(snowbough_warnings INTERFACE -Wall -Wextra -Wpedantic -Werror)
endif()

# Bit-identical results for the same input need the same arithmetic on every call:
# no fused multiply-add chosen by the compiler.
target_compile_options(snowbough_warnings INTERFACE -ffp-contract=off)

# snowbough_library(NAME SOURCES... ): a static library whose headers are included as <folder>/<header>.h
function(snowbough_library name)
  add_library(${name} STATIC ${ARGN})
  target_include_directories(${name} PUBLIC "${CMAKE_SOURCE_DIR}/native")
  target_link_libraries(${name} PRIVATE snowbough_warnings)
endfunction()
