# C and other code from ICDs as a step of the build. `icdgen --cmake-dir` says in which folder this file lies:
#
#   cmake -DCMAKE_MODULE_PATH="$(icdgen --cmake-dir)" ...
#
#   include(icdgen)
#   icdgen_add_library(<target> LANG c ICDS <file>... [OUT <folder>] [TEMPLATES <folder>] [HEADER_ONLY])
#   target_link_libraries(<program> PRIVATE <target>)
#
# <target> is a library whose include folder holds the generated headers, and which has the functions of the wire layer
# once, however many units use it (ICDGEN_SHARED). With HEADER_ONLY, for a language other than C, and in a project without
# C it is an INTERFACE library: each unit has those that it uses for itself. All is generated before anything that links
# it is compiled, and again when an ICD changes, its errata, or a file that it includes. Files whose content stays the
# same are not touched, so only what uses the changed messages is compiled again.
#
# ICDGEN_COMMAND, a list, is the command to run; by default `icdgen` from the PATH, else `python -m icdgen`.

cmake_minimum_required(VERSION 3.20)

# The build step itself: this file, run as a script.
if(CMAKE_SCRIPT_MODE_FILE AND CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  execute_process(COMMAND ${COMMAND} --depfile "${STEM}.d.all" RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "icdgen failed (${status})")
  endif()
  file(READ "${STEM}.d.all" text)
  string(FIND "${text}" ": \\\n" colon)
  string(SUBSTRING "${text}" 0 ${colon} outputs)
  string(SUBSTRING "${text}" ${colon} -1 inputs)
  # For the build tool the stamp stands for all headers.
  string(REPLACE " " "\\ " target "${STEM}.stamp")
  file(WRITE "${STEM}.d" "${target}${inputs}")
  file(TOUCH "${STEM}.stamp")
  # Ninja has to know what is written: when that changes, the next build configures again.
  string(REPLACE " \\\n  " "\n" outputs "${outputs}")
  string(REGEX REPLACE "\\\\([ #:\\\\])" "\\1" outputs "${outputs}")
  string(REPLACE "$$" "$" outputs "${outputs}")
  # All sources, which CMake cannot know before the first build, as one; it is never empty, as C demands.
  set(sources "typedef int icdgen_sources_t;\n")
  string(REPLACE "\n" ";" files "${outputs}")
  foreach(file IN LISTS files)
    if(file MATCHES "\\.c$")
      string(APPEND sources "#include \"${file}\"\n")
    endif()
  endforeach()
  set(known "")
  if(EXISTS "${STEM}.c")
    file(READ "${STEM}.c" known)
  endif()
  if(NOT known STREQUAL sources)
    file(WRITE "${STEM}.c" "${sources}")
  endif()
  file(READ "${STEM}.outputs" known)
  if(NOT known STREQUAL outputs)
    file(WRITE "${STEM}.outputs" "${outputs}")
  endif()
  return()
endif()

include_guard(GLOBAL)
set(_ICDGEN_MODULE "${CMAKE_CURRENT_LIST_FILE}")

function(_icdgen_find_command)
  if(DEFINED ICDGEN_COMMAND)
    return()
  endif()
  find_program(ICDGEN_EXECUTABLE icdgen)
  if(ICDGEN_EXECUTABLE)
    set(command "${ICDGEN_EXECUTABLE}")
  else()
    find_package(Python3 3.11 REQUIRED COMPONENTS Interpreter)
    execute_process(COMMAND "${Python3_EXECUTABLE}" -c "import icdgen" RESULT_VARIABLE status ERROR_QUIET)
    if(NOT status EQUAL 0)
      message(FATAL_ERROR "icdgen is not installed: `pip install icdgen`, or set ICDGEN_COMMAND")
    endif()
    set(command "${Python3_EXECUTABLE};-m;icdgen")
  endif()
  set(ICDGEN_COMMAND "${command}" CACHE STRING "Command that runs icdgen")
endfunction()

function(icdgen_add_library target)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "HEADER_ONLY" "LANG;OUT;TEMPLATES" "ICDS")
  if(NOT ARG_LANG OR NOT ARG_ICDS OR ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "usage: icdgen_add_library(<target> LANG <language> ICDS <file>... [OUT <folder>] [TEMPLATES <folder>] [HEADER_ONLY])")
  endif()
  _icdgen_find_command()

  set(out "${CMAKE_CURRENT_BINARY_DIR}/${target}")
  if(ARG_OUT)
    get_filename_component(out "${ARG_OUT}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_BINARY_DIR}")
  endif()
  set(icds "")
  foreach(icd IN LISTS ARG_ICDS)
    get_filename_component(icd "${icd}" ABSOLUTE)
    list(APPEND icds "${icd}")
  endforeach()
  set(stem "${CMAKE_CURRENT_BINARY_DIR}/${target}-icdgen")
  set(command ${ICDGEN_COMMAND} generate --quiet --lang "${ARG_LANG}" --out "${out}")
  if(ARG_TEMPLATES)
    get_filename_component(templates "${ARG_TEMPLATES}" ABSOLUTE)
    list(APPEND command --templates "${templates}")
  endif()
  list(APPEND command ${icds})

  list(GET ICDGEN_COMMAND 0 program)
  if(NOT EXISTS "${program}")
    set(program "")
  endif()
  if(NOT EXISTS "${stem}.outputs")
    file(TOUCH "${stem}.outputs")
  endif()
  file(STRINGS "${stem}.outputs" outputs)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${stem}.outputs")
  add_custom_command(
    OUTPUT "${stem}.stamp"
    BYPRODUCTS "${stem}.c" ${outputs}
    COMMAND "${CMAKE_COMMAND}" "-DCOMMAND=${command}" "-DSTEM=${stem}" -P "${_ICDGEN_MODULE}"
    DEPENDS ${icds} ${program} "${_ICDGEN_MODULE}"
    DEPFILE "${stem}.d"
    COMMENT "Generating ${target} (${ARG_LANG})"
    VERBATIM)
  add_custom_target(${target}-icdgen DEPENDS "${stem}.stamp")
  get_property(languages GLOBAL PROPERTY ENABLED_LANGUAGES)
  if(ARG_LANG STREQUAL "c" AND "C" IN_LIST languages AND NOT ARG_HEADER_ONLY)
    add_library(${target} STATIC "${stem}.c")
    target_compile_definitions(${target} PUBLIC ICDGEN_SHARED)
    target_include_directories(${target} PUBLIC "${out}")
    target_compile_features(${target} PRIVATE c_std_99)
  else()
    add_library(${target} INTERFACE)
    target_include_directories(${target} INTERFACE "${out}")
  endif()
  add_dependencies(${target} ${target}-icdgen)
endfunction()
