# snowbough_embed_shaders(TARGET): embeds the text of every file in shaders/, shaders/lib/ and shaders/glsl/ in
# TARGET, so that the module needs no separate files. gpu/shader_source.h finds them by file name, without the folder.
function(snowbough_embed_shaders target)
  file(GLOB shader_files CONFIGURE_DEPENDS
       "${CMAKE_SOURCE_DIR}/shaders/*.glsl" "${CMAKE_SOURCE_DIR}/shaders/lib/*.h"
       "${CMAKE_SOURCE_DIR}/shaders/glsl/*.glsl")
  set(generated "${CMAKE_CURRENT_BINARY_DIR}/embedded_shaders.cpp")
  add_custom_command(
    OUTPUT "${generated}"
    COMMAND ${CMAKE_COMMAND} "-DFILES=${shader_files}" "-DOUTPUT=${generated}"
            -P "${CMAKE_SOURCE_DIR}/cmake/WriteEmbeddedShaders.cmake"
    DEPENDS ${shader_files} "${CMAKE_SOURCE_DIR}/cmake/WriteEmbeddedShaders.cmake"
    COMMENT "Embedding the shaders"
    VERBATIM)
  target_sources(${target} PRIVATE "${generated}")
endfunction()
