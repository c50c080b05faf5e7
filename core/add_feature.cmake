# Optional libraries. Each is searched for, then tried: a few lines are compiled against its headers
# and linked against its libraries. A library that is missing or does not work here costs its
# feature, never the build. The reasons go into a C table that `cubewright version --features` prints.

set(feature_rows "")
set(extension_of_C c)
set(extension_of_CXX cpp)

# A text between quotes, as C writes it.
function(quote_for_c result text)
  string(REPLACE "\\" "\\\\" text "${text}")
  string(REPLACE "\"" "\\\"" text "${text}")
  set(${result} "\"${text}\"" PARENT_SCOPE)
endfunction()

# The first error of a compiler's or linker's output: the file without its folder, and the message.
function(find_first_error result output)
  set(error "see CMakeFiles/CMakeError.log")
  string(REPLACE ";" "," output "${output}")
  string(REGEX MATCH "[^\n]*(error: |undefined reference|cannot find |No rule to make )[^\n]*" line "${output}")
  if(line)
    string(REGEX REPLACE "^.*ninja: error: " "" line "${line}")
    string(REGEX REPLACE "^(/usr/bin/ld: |[^ ']*/include/|[^ ']*/)" "" line "${line}")
    string(REGEX REPLACE "^[^ ]*: in function `[^']*': *" "" line "${line}")
    string(SUBSTRING "${line}" 0 200 error)
  endif()
  set(${result} "${error}" PARENT_SCOPE)
endfunction()

# Whether the preprocessor finds all that a library's headers include: much faster than compiling
# them. Sets ${result} to the first error, or to nothing.
function(preprocess_headers result name)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${name}_headers.cpp)
  list(TRANSFORM A_HEADERS REPLACE "(.+)" "#include <\\1>\n" OUTPUT_VARIABLE lines)
  list(JOIN lines "" lines)
  file(WRITE ${source} "${lines}")
  list(TRANSFORM A_INCLUDES PREPEND -I OUTPUT_VARIABLE folders)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -std=c++17 ${folders} -E ${source} -o /dev/null
    RESULT_VARIABLE failed ERROR_VARIABLE output)
  set(error "")
  if(failed)
    find_first_error(error "${output}")
  endif()
  set(${result} "${error}" PARENT_SCOPE)
endfunction()

# Why a feature cannot be had: an option that is off, a package that was not found, or the first
# error of the trial; empty when the library works.
function(try_library result name)
  if(NOT ${A_OPTION})
    set(${result} "switched off by ${A_OPTION}=OFF" PARENT_SCOPE)
    return()
  endif()
  set(missing "")
  if(A_LANGUAGE STREQUAL CXX AND NOT CMAKE_CXX_COMPILER)
    list(APPEND missing g++)
  endif()
  foreach(pair ${A_NEEDS})
    string(REGEX MATCH "^([^=]+)=(.+)$" pair "${pair}")
    if(NOT ${CMAKE_MATCH_1})
      list(APPEND missing ${CMAKE_MATCH_2})
    endif()
  endforeach()
  if(missing)
    list(REMOVE_DUPLICATES missing)
    list(JOIN missing ", " missing)
    set(${result} "not found: ${missing}" PARENT_SCOPE)
    return()
  endif()

  # A success is cached. A failure is tried again: the missing header may be there the next time.
  set(tried CUBEWRIGHT_TRIED_${name})
  set(error "")
  if(NOT ${tried} AND A_HEADERS)
    preprocess_headers(error ${name})
  endif()
  if(NOT ${tried} AND NOT error)
    unset(${tried} CACHE)
    set(CMAKE_TRY_COMPILE_CONFIGURATION Release) # no debug information: half the time
    set(CMAKE_${A_LANGUAGE}_FLAGS_RELEASE -O0)
    try_compile(${tried} SOURCE_FROM_VAR ${name}.${extension_of_${A_LANGUAGE}} A_TRIAL
      CMAKE_FLAGS "-DINCLUDE_DIRECTORIES=${A_INCLUDES}" LINK_LIBRARIES ${A_LIBRARIES}
      OUTPUT_VARIABLE output CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON)
    if(NOT ${tried})
      find_first_error(error "${output}")
    endif()
  endif()
  if(NOT error)
    set(${result} "" PARENT_SCOPE)
  else()
    list(JOIN A_PACKAGES ", " packages)
    set(${result} "${packages} cannot be used: ${error}" PARENT_SCOPE)
  endif()
endfunction()

# add_feature(NAME OPTION OPTION PACKAGES PACKAGE... ABOUT TEXT COST TEXT LICENCES TEXT [MODULE NAME]
#   [SHIPPED PACKAGE] [LANGUAGE CXX] NEEDS VARIABLE=PACKAGE... [HEADERS FILE...] [INCLUDES FOLDER...]
#   LIBRARIES LIBRARY... TRIAL SOURCE)
# add_feature(NAME OPTION ... COST TEXT [LICENCES TEXT] [MODULE NAME] LIKE FEATURE)
#
# Sets HAS_<NAME>, in capitals and with _ for -, and adds a row to the table.
# ABOUT says what the feature brings. COST ends the sentence "this build ...".
# LICENCES lists its libraries and their licences, as SPDX names them.
# MODULE is the shared object that the feature lives in, if any.
# SHIPPED is our Debian package with that object (cli/debian), libcubewright0 unless it is another.
# NEEDS lists variables that must be true, each with the package that makes it so.
# TRIAL is a whole program. HEADERS are too slow to compile for a trial: the preprocessor reads them.
# LANGUAGE is C unless it is CXX. LIKE names a feature of the same library, tried already.
function(add_feature name)
  cmake_parse_arguments(PARSE_ARGV 1 A "" "OPTION;ABOUT;COST;LICENCES;MODULE;SHIPPED;LANGUAGE;TRIAL;LIKE"
    "PACKAGES;NEEDS;HEADERS;INCLUDES;LIBRARIES")
  if(NOT A_LANGUAGE)
    set(A_LANGUAGE C)
  endif()
  if(NOT A_SHIPPED)
    set(A_SHIPPED libcubewright0)
  endif()
  set(ENV{LC_ALL} C) # errors are read in English
  if(A_LIKE)
    set(reason "${reason_of_${A_LIKE}}")
    if(NOT A_LICENCES)
      set(A_LICENCES "${licences_of_${A_LIKE}}")
    endif()
  else()
    try_library(reason ${name})
  endif()
  string(TOUPPER HAS_${name} variable)
  string(REPLACE - _ variable ${variable})
  set(has ON)
  if(reason)
    set(has OFF)
    message(STATUS "without ${name}: ${reason}; this build ${A_COST}")
  endif()
  list(JOIN A_PACKAGES " " packages)
  set(row "")
  foreach(text "${name}" "${A_ABOUT}" "${A_MODULE}" "${A_SHIPPED}" "${A_OPTION}" "${packages}" "${A_LICENCES}" "${reason}")
    quote_for_c(quoted "${text}")
    string(APPEND row "${quoted}, ")
  endforeach()
  string(REGEX REPLACE ", $" "" row "${row}")
  set(feature_rows "${feature_rows}    {${row}},\n" PARENT_SCOPE)
  set(reason_of_${name} "${reason}" PARENT_SCOPE)
  set(licences_of_${name} "${A_LICENCES}" PARENT_SCOPE)
  set(${variable} ${has} PARENT_SCOPE)
endfunction()
