# Builds the libraries from the sources that tools/third_party.sh has fetched and links them statically into the module.
# Their symbols are not visible outside the module.
set(third_party "${CMAKE_SOURCE_DIR}/build/third_party")
if(NOT EXISTS "${third_party}/sources/zlib/zlib.h")
  message(FATAL_ERROR "SNOWBOUGH_BUNDLED needs the libraries' sources: run ./tools/third_party.sh first")
endif()
enable_language(C)
find_package(Threads REQUIRED)
set(sources "${third_party}/sources")
set(BUILD_SHARED_LIBS OFF)
set(CMAKE_C_VISIBILITY_PRESET hidden)

# snowbough_bundled_headers(NAME FOLDERS...): a header-only library. SYSTEM suppresses warnings from its headers.
function(snowbough_bundled_headers name)
  add_library(${name} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${name} SYSTEM INTERFACE ${ARGN})
endfunction()
snowbough_bundled_headers(glm::glm "${sources}/glm")
snowbough_bundled_headers(Eigen3::Eigen "${sources}/eigen3")
snowbough_bundled_headers(pybind11::headers "${third_party}/pybind11/pybind11/include")

file(GLOB zlib_files "${sources}/zlib/*.c")
list(FILTER zlib_files EXCLUDE REGEX "/gz[a-z]*\\.c$")
add_library(zlib STATIC ${zlib_files})
target_compile_options(zlib PRIVATE -w)
if(APPLE)
  # Otherwise zutil.h takes macOS for the Mac OS of the 1990s and replaces fdopen by nothing.
  target_compile_definitions(zlib PRIVATE fdopen=fdopen)
endif()
target_include_directories(zlib SYSTEM PUBLIC "${sources}/zlib")
add_library(ZLIB::ZLIB ALIAS zlib)

# OpenMesh: only the half-edge mesh, without the file formats.
file(GLOB openmesh_files "${sources}/openmesh/src/OpenMesh/Core/Mesh/*.cc"
  "${sources}/openmesh/src/OpenMesh/Core/Utils/*.cc" "${sources}/openmesh/src/OpenMesh/Core/System/*.cc")
add_library(OpenMeshCore STATIC ${openmesh_files})
target_compile_options(OpenMeshCore PRIVATE -w)
target_compile_definitions(OpenMeshCore PUBLIC OM_STATIC_BUILD _USE_MATH_DEFINES)
target_include_directories(OpenMeshCore SYSTEM PUBLIC "${sources}/openmesh/src")

# OpenEXR and Imath have their own CMake builds.
set(IMATH_INSTALL OFF)
set(IMATH_INSTALL_PKG_CONFIG OFF)
set(OPENEXR_INSTALL OFF)
set(OPENEXR_INSTALL_TOOLS OFF)
set(OPENEXR_INSTALL_PKG_CONFIG OFF)
set(OPENEXR_BUILD_TOOLS OFF)
set(BUILD_TESTING OFF)
# Otherwise OpenEXR and Imath mark their names as public. On Linux and Windows, a list of exported names hides them.
set(IMATH_USE_DEFAULT_VISIBILITY ${APPLE})
set(OPENEXR_USE_DEFAULT_VISIBILITY ${APPLE})
set(CMAKE_POLICY_DEFAULT_CMP0077 NEW)
add_subdirectory("${sources}/imath" imath EXCLUDE_FROM_ALL SYSTEM)
# Imath is a subproject, so OpenEXR's find_package(Imath) must not search for an installed one.
file(WRITE "${CMAKE_BINARY_DIR}/find/FindImath.cmake" "set(Imath_FOUND TRUE)\n")
list(PREPEND CMAKE_MODULE_PATH "${CMAKE_BINARY_DIR}/find")
add_subdirectory("${sources}/openexr" openexr EXCLUDE_FROM_ALL SYSTEM)
foreach(library Imath OpenEXR OpenEXRCore Iex IlmThread)
  target_compile_options(${library} PRIVATE -w)
  set_target_properties(${library} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endforeach()

# libepoxy: its own script generates the dispatch code, which loads EGL and OpenGL on the first call.
find_package(Python COMPONENTS Interpreter REQUIRED)
set(epoxy_kinds gl)
if(WIN32)
  list(APPEND epoxy_kinds wgl)
elseif(NOT APPLE)
  list(APPEND epoxy_kinds egl)
endif()
set(epoxy_built "${CMAKE_BINARY_DIR}/epoxy")
set(epoxy_files "${sources}/libepoxy/src/dispatch_common.c")
foreach(kind IN LISTS epoxy_kinds)
  if(NOT EXISTS "${epoxy_built}/src/${kind}_generated_dispatch.c")
    file(MAKE_DIRECTORY "${epoxy_built}/include/epoxy" "${epoxy_built}/src")
    execute_process(
      COMMAND "${Python_EXECUTABLE}" "${sources}/libepoxy/src/gen_dispatch.py" --source --header
              "--srcdir=${epoxy_built}/src" "--includedir=${epoxy_built}/include/epoxy"
              "${sources}/libepoxy/registry/${kind}.xml"
      COMMAND_ERROR_IS_FATAL ANY)
  endif()
  list(APPEND epoxy_files "${epoxy_built}/src/${kind}_generated_dispatch.c")
  if(EXISTS "${sources}/libepoxy/src/dispatch_${kind}.c")
    list(APPEND epoxy_files "${sources}/libepoxy/src/dispatch_${kind}.c")
  endif()
endforeach()
set(has_egl 0)
if(egl IN_LIST epoxy_kinds)
  set(has_egl 1)
  # External headers of libepoxy (from Debian's libegl-dev). They are the same on all systems.
  foreach(header EGL/eglplatform.h KHR/khrplatform.h)
    configure_file("/usr/include/${header}" "${epoxy_built}/include/${header}" COPYONLY)
  endforeach()
endif()
file(CONFIGURE OUTPUT "${epoxy_built}/src/config.h" CONTENT
  "#define ENABLE_EGL @has_egl@\n#define ENABLE_GLX 0\n#define ENABLE_X11 0\n#define EPOXY_PUBLIC extern\n" @ONLY)
add_library(epoxy STATIC ${epoxy_files})
# libepoxy casts Apple's GLhandleARB, a pointer, to an integer, which Clang takes for an error.
target_compile_options(epoxy PRIVATE -w -fno-strict-aliasing $<$<PLATFORM_ID:Darwin>:-Wno-int-conversion>)
target_compile_definitions(epoxy PUBLIC EGL_NO_X11 EPOXY_PUBLIC=extern)
target_include_directories(epoxy SYSTEM PUBLIC "${sources}/libepoxy/include" "${epoxy_built}/include"
  PRIVATE "${sources}/libepoxy/src" "${epoxy_built}/src")
if(WIN32)
  # libepoxy's DllMain becomes the DllMain of the module. It allocates the memory for each thread's function pointers.
  target_link_libraries(epoxy PUBLIC opengl32 gdi32)
else()
  target_link_libraries(epoxy PUBLIC ${CMAKE_DL_LIBS})
endif()
add_library(PkgConfig::epoxy ALIAS epoxy)

# If Python terminates a thread during its own shutdown, glibc unwinds the thread's stack with the system's libgcc_s
# (python/released_gil.h delays that). The module must use the same unwinder, not the one that zig links statically. So
# it imports the functions from libgcc_s.so.1, which exists on every system with glibc. This stub library only declares
# their names for the linker.
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
  set(unwinder "")
  foreach(name Backtrace DeleteException FindEnclosingFunction ForcedUnwind GetCFA GetDataRelBase GetGR GetIP GetIPInfo
               GetLanguageSpecificData GetRegionStart GetTextRelBase RaiseException Resume Resume_or_Rethrow SetGR SetIP)
    string(APPEND unwinder "void _Unwind_${name}(void) {}\n")
  endforeach()
  file(CONFIGURE OUTPUT "${CMAKE_BINARY_DIR}/unwinder.c" CONTENT "${unwinder}" @ONLY)
  add_library(unwinder SHARED "${CMAKE_BINARY_DIR}/unwinder.c")
  set_target_properties(unwinder PROPERTIES NO_SONAME ON C_VISIBILITY_PRESET default)
  target_link_options(unwinder PRIVATE -nostdlib -Wl,-soname,libgcc_s.so.1)
endif()

# SNOWBOUGH_WIDE (base/simd.h): functions compiled for AVX-512, AVX2 and the baseline. The format of Linux's libraries can
# choose between them at load time, that of Windows' libraries cannot. zig's runtime library does not contain the test
# of the processor that the choice calls.
if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
  set(SNOWBOUGH_CLONES ON)
  add_compile_definitions(SNOWBOUGH_CLONES)
  add_library(cpu_model STATIC "${CMAKE_CURRENT_LIST_DIR}/cpu_model.c")
endif()
