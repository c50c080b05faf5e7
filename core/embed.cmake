# Texts as C: each NAME.EXT becomes the string PREFIX_NAME. When this is included it defines
# embed_files(); at build time that runs it as a script:
# cmake -DOUT=FILE -DPREFIX=cwi_glsl "-DIN=a.glsl;b.glsl" -P embed.cmake
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(embed_script ${CMAKE_CURRENT_LIST_FILE})

  # Makes NAME.c of the files that match a pattern; the variable NAME becomes its path.
  function(embed_files name prefix pattern)
    file(GLOB files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${pattern})
    set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.c)
    add_custom_command(OUTPUT ${source}
      COMMAND ${CMAKE_COMMAND} -DOUT=${source} -DPREFIX=${prefix} "-DIN=${files}" -P ${embed_script}
      DEPENDS ${files} ${embed_script} VERBATIM)
    set(${name} ${source} PARENT_SCOPE)
  endfunction()
  return()
endif()

set(text "/* Made by core/embed.cmake. */\n")
foreach(file ${IN})
  cmake_path(GET file STEM name)
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(REGEX REPLACE "(0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,)" "\\1\n" bytes "${bytes}")
  string(APPEND text "extern const char ${PREFIX}_${name}[];\nconst char ${PREFIX}_${name}[] = {\n${bytes}0};\n")
endforeach()
file(WRITE ${OUT} "${text}")
