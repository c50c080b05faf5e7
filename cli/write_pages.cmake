# Writes the manual pages and the scripts for the completion of shells; at build time:
# cmake -DPROGRAM=cubewright -DEMULATOR=... -DOUT=FOLDER "-DNAMES=extract;..." -P write_pages.cmake
function(write_output file)
  cmake_path(GET file PARENT_PATH folder)
  file(MAKE_DIRECTORY ${folder})
  execute_process(COMMAND ${EMULATOR} ${PROGRAM} help ${ARGN} OUTPUT_FILE ${file}
    RESULT_VARIABLE failed)
  if(failed)
    file(REMOVE ${file})
    message(FATAL_ERROR "${PROGRAM} help ${ARGN}: ${failed}")
  endif()
endfunction()

foreach(name ${NAMES})
  write_output(${OUT}/man/man1/cubewright-${name}.1 --man ${name})
endforeach()
write_output(${OUT}/man/man1/cubewright.1 --man cubewright)
write_output(${OUT}/man/man3/cubewright.3 --man library)
write_output(${OUT}/completion/bash/cubewright --completion bash)
write_output(${OUT}/completion/zsh/_cubewright --completion zsh)
write_output(${OUT}/completion/fish/cubewright.fish --completion fish)
file(TOUCH ${OUT}/pages)
