# The documents of the C API: `cmake --build build/release --target docs` makes HTML of the public
# headers and of the pages beside this file, in docs/html of the build folder. Nothing is fetched
# from a network. A warning of Doxygen is an error.
find_program(DOXYGEN doxygen)
find_program(AWK awk)
set(docs_sources ${PROJECT_SOURCE_DIR}/include/docs)
set(docs_folder ${PROJECT_BINARY_DIR}/docs)
configure_file(${docs_sources}/Doxyfile.in ${docs_folder}/Doxyfile @ONLY)

if(CUBEWRIGHT_DOCS)
  need(DOXYGEN doxygen "CUBEWRIGHT_DOCS is ON")
  install(DIRECTORY ${docs_folder}/html DESTINATION ${CMAKE_INSTALL_DOCDIR})
  set(docs_with_all ALL)
endif()
if(DOXYGEN AND AWK)
  file(GLOB docs_inputs CONFIGURE_DEPENDS include/cubewright/*.h ${docs_sources}/*)
  add_custom_command(OUTPUT ${docs_folder}/html/index.html
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${docs_folder}/html
    COMMAND ${DOXYGEN} ${docs_folder}/Doxyfile
    DEPENDS ${docs_inputs} ${docs_folder}/Doxyfile
    COMMENT "Making docs/html of the public headers" VERBATIM)
  add_custom_target(docs ${docs_with_all} DEPENDS ${docs_folder}/html/index.html)
else()
  add_custom_target(docs
    COMMAND ${CMAKE_COMMAND} -E echo "no documents: doxygen is missing (apt-get install doxygen)" VERBATIM)
endif()
