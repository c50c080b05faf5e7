# What `cmake --install` puts into a prefix besides the program and the modules: the library, its
# headers, and the files by which CMake and pkg-config find it. The whole prefix can be moved.
install(TARGETS cubewright EXPORT cubewright)
install(DIRECTORY include/cubewright DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

# The libraries of a static library, as -lNAME: their users need no CMake packages of them.
set(static_libraries "")
foreach(library z expat png jansson pthread m dl)
  list(APPEND static_libraries -l${library})
endforeach()
foreach(pair SECCOMP=seccomp ISAL=isal LZ4=lz4 BZIP2=bz2 ZSTD=zstd)
  string(REGEX MATCH "^(.*)=(.*)$" pair ${pair})
  if(HAS_${CMAKE_MATCH_1})
    list(APPEND static_libraries -l${CMAKE_MATCH_2})
  endif()
endforeach()
list(JOIN static_libraries " " static_flags)

if(CUBEWRIGHT_STATIC)
  set_target_properties(cubewright_static PROPERTIES OUTPUT_NAME cubewright LINKER_LANGUAGE C)
  target_link_libraries(cubewright_static INTERFACE ${static_libraries})
  target_include_directories(cubewright_static INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  install(TARGETS cubewright_static EXPORT cubewright)
endif()

install(EXPORT cubewright NAMESPACE cubewright:: FILE cubewright-config.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/cubewright)
include(CMakePackageConfigHelpers)
write_basic_package_version_file(cubewright-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/cubewright-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/cubewright)

# pkg-config's prefix is found from the file's own place, ${pcfiledir}.
file(RELATIVE_PATH to_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
string(REGEX REPLACE "/$" "" to_prefix ${to_prefix})
configure_file(core/cubewright.pc.in cubewright.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/cubewright.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
