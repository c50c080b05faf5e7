# Makes a C file of texts: each NAME.EXT becomes the string PREFIX_NAME.
# cmake -DOUT=FILE -DPREFIX=cwi_glsl "-DIN=a.glsl;b.glsl" -P embed.cmake
set(text "/* Made by core/embed.cmake. */\n")
foreach(file ${IN})
  cmake_path(GET file STEM name)
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(REGEX REPLACE "(0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,)" "\\1\n" bytes "${bytes}")
  string(APPEND text "extern const char ${PREFIX}_${name}[];\nconst char ${PREFIX}_${name}[] = {\n${bytes}0};\n")
endforeach()
file(WRITE ${OUT} "${text}")
