# Makes a C file of shaders: each NAME.glsl becomes the string cwi_glsl_NAME.
# cmake -DOUT=FILE "-DIN=a.glsl;b.glsl" -P glsl.cmake
set(text "/* Made by viewer/glsl.cmake. */\n")
foreach(file ${IN})
  cmake_path(GET file STEM name)
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(REGEX REPLACE "(0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,)" "\\1\n" bytes "${bytes}")
  string(APPEND text "extern const char cwi_glsl_${name}[];\nconst char cwi_glsl_${name}[] = {\n${bytes}0};\n")
endforeach()
file(WRITE ${OUT} "${text}")
