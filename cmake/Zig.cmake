# Toolchain file: compiles for SNOWBOUGH_SYSTEM (linux, windows or macos) on any x86-64 Linux, with the zig that
# tools/third_party.sh has fetched. zig contains Clang and the C libraries of all three systems.
#
#   cmake -S . -B build/windows -G Ninja --toolchain cmake/Zig.cmake -DSNOWBOUGH_SYSTEM=windows -DSNOWBOUGH_BUNDLED=ON
#
# libc++ is linked statically on all systems. On Windows, the module does not use Microsoft's C++ runtime: Blender loads
# its own MSVCP140.dll before any extension, and a module that was built with a newer version crashes in it.
set(SNOWBOUGH_SYSTEM linux CACHE STRING "linux, windows or macos")
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES SNOWBOUGH_SYSTEM)
get_filename_component(root "${CMAKE_CURRENT_LIST_DIR}/.." ABSOLUTE)

if(SNOWBOUGH_SYSTEM STREQUAL "linux")
  set(CMAKE_SYSTEM_NAME Linux)
  set(CMAKE_SYSTEM_PROCESSOR x86_64)
  set(target x86_64-linux-gnu.2.28)
elseif(SNOWBOUGH_SYSTEM STREQUAL "windows")
  set(CMAKE_SYSTEM_NAME Windows)
  set(CMAKE_SYSTEM_PROCESSOR AMD64)
  set(target x86_64-windows-gnu)
elseif(SNOWBOUGH_SYSTEM STREQUAL "macos")
  set(CMAKE_SYSTEM_NAME Darwin)
  set(CMAKE_SYSTEM_PROCESSOR arm64)
  set(CMAKE_OSX_ARCHITECTURES arm64)
  set(CMAKE_OSX_SYSROOT "")
  set(CMAKE_OSX_DEPLOYMENT_TARGET "")
  set(CMAKE_INSTALL_NAME_TOOL /bin/true)
  set(target aarch64-macos.11.0)
else()
  message(FATAL_ERROR "SNOWBOUGH_SYSTEM must be linux, windows or macos, not '${SNOWBOUGH_SYSTEM}'")
endif()

# CMake and ccache need programs, not commands with arguments.
set(wrappers "${root}/build/third_party/zig-${target}")
foreach(name_and_command "cc|cc -target ${target}" "c++|c++ -target ${target}" "ar|ar" "ranlib|ranlib" "rc|rc")
  string(REPLACE "|" ";" pair "${name_and_command}")
  list(GET pair 0 name)
  list(GET pair 1 command)
  set(text "#!/bin/sh\nexec ${root}/build/third_party/ziglang/ziglang/zig ${command} \"$@\"\n")
  set(present "")
  if(EXISTS "${wrappers}/${name}")
    file(READ "${wrappers}/${name}" present)
  endif()
  if(NOT present STREQUAL text)
    file(WRITE "${wrappers}/${name}" "${text}")
    file(CHMOD "${wrappers}/${name}" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
  endif()
endforeach()
set(CMAKE_C_COMPILER "${wrappers}/cc")
set(CMAKE_CXX_COMPILER "${wrappers}/c++")
# Without -g0, zig adds debug information.
set(CMAKE_C_FLAGS_INIT -g0)
set(CMAKE_CXX_FLAGS_INIT -g0)
set(CMAKE_AR "${wrappers}/ar" CACHE FILEPATH "")
set(CMAKE_RANLIB "${wrappers}/ranlib" CACHE FILEPATH "")
set(CMAKE_RC_COMPILER "${wrappers}/rc")

set(CMAKE_FIND_ROOT_PATH "${wrappers}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
