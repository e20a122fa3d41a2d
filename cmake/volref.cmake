# Tests of a volume renderer by volref, one CTest test for each case:
#
#   list(APPEND CMAKE_MODULE_PATH /path/to/volref/cmake)
#   include(volref)
#   volref_add_tests(
#     COMMAND $<TARGET_FILE:my-renderer> {scene} --out {output} --spp {spp}
#     CASES figures fog/forward      # families, cases, or patterns such as fog/*; !fog/thick is left out
#     SPP 256)
#
# Words in braces are those of `volref validate --run` ({scene}, {output}, {width}, {height}, {spp}, {seed},
# {case}, {step}, {rate}, {export:mitsuba}, {export:pbrt}, {export:bundle}). Further arguments:
#
#   SPP N           samples per pixel, {spp}               FORMAT EXT   of {output}: exr, pfm, npy or png
#   TIMEOUT SECONDS for the renderer                       PROFILE FILE conventions to judge by: vtk, anari, a file
#   PREFIX TEXT     of the names of tests [volref/]        SUITE DIR    in place of the suite within volref
#   LABELS TEXT...  of the tests [volref]                  REPORTS DIR  a page for each case below DIR
#   KNOWN FILE      known failures: their tests pass until they are mended, worse or otherwise. For the first file run
#                   volref validate CASES --run 'COMMAND' --known FILE --known-update
#   EXPLAIN SECONDS for finding the mistake behind a wrong image [10; 0 where the environment variable CI is set]
#
# Relative paths of PROFILE, KNOWN and SUITE begin at the current source folder, that of REPORTS at the current build folder.
#
#   ACCEPT_CONVENTIONS   passes what is right under other conventions
#
# A test passes and fails as `volref validate` does, and is skipped where the image is too noisy to decide. Where nothing
# is compared it fails, as where the suite lacks the case by now.
# Metrics and pictures are CTest's measurements; CDash lays TestImage over ValidImage, with a slider.
# The program is VOLREF_PROGRAM, else `volref` on the search path. Needs CMake 3.21 and volref when configured.

cmake_minimum_required(VERSION 3.21)

# Appends an option to a list of arguments, in which a ";" of its value is no end.
function(_volref_option list flag value)
  string(REPLACE ";" "\\;" value "${value}")
  list(APPEND ${list} "${flag}=${value}")
  set(${list} "${${list}}" PARENT_SCOPE)
endfunction()

function(volref_add_tests)
  set(flags ACCEPT_CONVENTIONS)
  set(values SPP FORMAT TIMEOUT PROFILE PREFIX SUITE REPORTS EXPLAIN KNOWN)
  set(lists COMMAND CASES LABELS)
  cmake_parse_arguments(PARSE_ARGV 0 arg "${flags}" "${values}" "${lists}")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "volref_add_tests: unknown argument ${arg_UNPARSED_ARGUMENTS}")
  endif()
  foreach(required COMMAND CASES)
    if(NOT arg_${required})
      message(FATAL_ERROR "volref_add_tests: ${required} is missing")
    endif()
  endforeach()
  find_program(VOLREF_PROGRAM volref DOC "The program volref" REQUIRED)
  if(NOT DEFINED arg_PREFIX)
    set(arg_PREFIX "volref/")
  endif()
  if(NOT arg_LABELS)
    set(arg_LABELS volref)
  endif()

  set(suite)
  if(arg_SUITE)
    get_filename_component(folder "${arg_SUITE}" ABSOLUTE)
    _volref_option(suite --suite "${folder}")
  endif()
  execute_process(
    COMMAND "${VOLREF_PROGRAM}" list ${arg_CASES} ${suite} --json
    WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}"
    OUTPUT_VARIABLE listed ERROR_VARIABLE said RESULT_VARIABLE exit_code)
  if(NOT exit_code EQUAL 0)
    message(FATAL_ERROR "volref_add_tests: ${said}")
  endif()

  # One word for --run, in which volref reads words as a shell does. From the arguments one by one: a list of
  # them would be split and joined anew by ";", "[" and "\" in a word.
  set(keywords ${flags} ${values} ${lists})
  set(command)
  set(keyword)
  math(EXPR last "${ARGC} - 1")
  foreach(index RANGE ${last})
    set(word "${ARGV${index}}")
    if(word IN_LIST keywords)
      set(keyword "${word}")
    elseif(keyword STREQUAL "COMMAND")
      string(REPLACE "'" "'\\''" word "${word}")
      string(APPEND command " '${word}'")
    endif()
  endforeach()

  # A file beside the CMakeLists.txt, unless it is a name within volref, which has no folder and no extension.
  if(DEFINED arg_PROFILE)
    get_filename_component(file "${arg_PROFILE}" ABSOLUTE)
    if(arg_PROFILE MATCHES "[/.]" OR (EXISTS "${file}" AND NOT IS_DIRECTORY "${file}"))
      set(arg_PROFILE "${file}")
    endif()
  endif()
  set(options)
  foreach(pair "SPP|--spp" "FORMAT|--format" "TIMEOUT|--timeout" "PROFILE|--as"
      "EXPLAIN|--explain")
    string(REPLACE "|" ";" pair "${pair}")
    list(GET pair 0 name)
    list(GET pair 1 flag)
    if(DEFINED arg_${name})
      _volref_option(options ${flag} "${arg_${name}}")
    endif()
  endforeach()
  if(DEFINED arg_KNOWN)
    get_filename_component(file "${arg_KNOWN}" ABSOLUTE)
    _volref_option(options --known "${file}")
  endif()
  if(arg_ACCEPT_CONVENTIONS)
    list(APPEND options --accept-conventions)
  endif()

  string(JSON count LENGTH "${listed}" cases)
  if(count EQUAL 0)
    message(FATAL_ERROR "volref_add_tests: no case has an image among ${arg_CASES}")
  endif()
  math(EXPR last "${count} - 1")
  foreach(index RANGE ${last})
    string(JSON case GET "${listed}" cases ${index} name)
    set(report)
    if(arg_REPORTS)
      get_filename_component(folder "${arg_REPORTS}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_BINARY_DIR}")
      _volref_option(report --report "${folder}/${case}")
    endif()
    set(test "${arg_PREFIX}${case}")
    add_test(NAME "${test}"
      COMMAND "${VOLREF_PROGRAM}" validate "${case}" --run "${command}" ${options} ${suite} ${report}
        --ctest "${CMAKE_CURRENT_BINARY_DIR}/volref-pictures"
      WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
    # Not by exit code 5, which is also that of nothing compared. What a renderer prints is indented.
    set_tests_properties("${test}" PROPERTIES
      SKIP_REGULAR_EXPRESSION "(^|\n)1 case: 0 passed, 1 inconclusive\n" LABELS "${arg_LABELS}")
  endforeach()
endfunction()
