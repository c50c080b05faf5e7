# Rooms and modules. tests/architecture/rooms.txt lists the rooms, and whom each may use.
#
# A room is an object library of a folder. The shared library is made of all but those of cli. It exports
# the public functions (cw_), and under a version that names this very release the internal ones (cwi_):
# for the program, for modules and for tests, which are built with it (core/cubewright.map.in).
#
# With CUBEWRIGHT_ROOMS (preset `rooms`) each room is a shared object of its own instead, linked with
# the rooms it may use and nothing else: a call through a wall is an undefined symbol.

option(CUBEWRIGHT_ROOMS "link each room by itself, to prove its walls; builds no program" OFF)

set(rooms_file ${PROJECT_SOURCE_DIR}/tests/architecture/rooms.txt)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${rooms_file})
file(STRINGS ${rooms_file} room_lines REGEX "^[a-z]")
foreach(line ${room_lines})
  string(REGEX MATCH "^([^:]*): *(.*)$" line "${line}")
  string(MAKE_C_IDENTIFIER "${CMAKE_MATCH_1}" room)
  string(REPLACE " " ";" uses_of_${room} "${CMAKE_MATCH_2}")
endforeach()

# The targets of the rooms that the room of a folder may use.
function(find_used_rooms result folder)
  string(MAKE_C_IDENTIFIER ${folder} room)
  if(NOT DEFINED uses_of_${room}) # a format: formats/*
    string(REGEX REPLACE "/.*" "__" room ${folder})
  endif()
  foreach(use ${uses_of_${room}})
    if(use STREQUAL core OR use MATCHES "/\\*$")
      string(REPLACE "/*" "" top ${use})
      file(GLOB folders LIST_DIRECTORIES ON RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/${top}/*)
      list(FILTER folders EXCLUDE REGEX "\\.")
      list(APPEND used ${folders})
    else()
      list(APPEND used ${use})
    endif()
  endforeach()
  list(TRANSFORM used REPLACE / _)
  list(TRANSFORM used REPLACE "(.+)" "$<TARGET_NAME_IF_EXISTS:\\1>")
  set(${result} "${used}" PARENT_SCOPE)
endfunction()

# Objects that belong to a room, compiled with options of their own.
function(add_room_part room objects)
  if(CUBEWRIGHT_ROOMS)
    target_link_libraries(${room} PRIVATE ${objects})
  elseif(room MATCHES "^cli")
    target_sources(cli_objects INTERFACE $<TARGET_OBJECTS:${objects}>)
  else()
    target_link_libraries(cubewright PRIVATE ${objects})
    if(CUBEWRIGHT_STATIC)
      target_sources(cubewright_static PRIVATE $<TARGET_OBJECTS:${objects}>)
    endif()
  endif()
endfunction()

# A fuzzer sees which branches of readers its inputs take. Elsewhere counting them would double the time.
function(count_branches target folder)
  if(CUBEWRIGHT_FUZZ AND folder MATCHES "^(core|formats|viewer/settings)")
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# A room is the C sources of a folder, without those behind EXCEPT, and what else is named.
function(add_room folder)
  cmake_parse_arguments(PARSE_ARGV 1 A "" "" "EXCEPT")
  string(REPLACE / _ room ${folder})
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.c)
  if(A_EXCEPT)
    list(TRANSFORM A_EXCEPT PREPEND ${PROJECT_SOURCE_DIR}/${folder}/)
    list(REMOVE_ITEM sources ${A_EXCEPT})
  endif()
  if(CUBEWRIGHT_ROOMS)
    add_library(${room} SHARED ${sources} ${A_UNPARSED_ARGUMENTS})
    find_used_rooms(used ${folder})
    target_link_libraries(${room} PRIVATE cw_settings ${used})
    target_link_options(${room} PRIVATE LINKER:-z,defs)
  else()
    add_library(${room} OBJECT ${sources} ${A_UNPARSED_ARGUMENTS})
    target_link_libraries(${room} PRIVATE cw_settings)
    add_room_part(${room} ${room})
    count_branches(${room} ${folder})
  endif()
endfunction()

# A module: a library behind one C struct of functions, loaded when first used. Its sources stand in
# a room, with whose other sources it may be linked.
function(add_cubewright_module name folder sources)
  string(REPLACE / _ room ${folder})
  list(TRANSFORM sources REPLACE "^([^/]+)$" "${PROJECT_SOURCE_DIR}/${folder}/\\1")
  add_library(module_${name} MODULE ${sources} ${PROJECT_SOURCE_DIR}/core/base/module_entry.c)
  count_branches(module_${name} ${folder})
  set_target_properties(module_${name} PROPERTIES PREFIX "" OUTPUT_NAME cubewright-${name}
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib/cubewright INSTALL_RPATH "$ORIGIN/..")
  if(NOT CUBEWRIGHT_SANITIZE) # whose runtime is in the program
    target_link_options(module_${name} PRIVATE LINKER:-z,defs)
  endif()
  # Each shared object names its C library, as Debian asks, even one that calls ours alone.
  target_link_options(module_${name} PRIVATE "SHELL:-Wl,--push-state,--no-as-needed -lc -Wl,--pop-state")
  if(CUBEWRIGHT_ROOMS)
    find_used_rooms(used ${folder})
    target_link_libraries(module_${name} PRIVATE $<TARGET_NAME_IF_EXISTS:${room}> ${used} cw_settings ${ARGN})
  else()
    target_link_libraries(module_${name} PRIVATE cubewright cw_settings ${ARGN})
  endif()
  install(TARGETS module_${name} DESTINATION ${CMAKE_INSTALL_LIBDIR}/cubewright OPTIONAL)
endfunction()
