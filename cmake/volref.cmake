# Tests of a volume renderer by volref, one CTest test for each case:
#
#   list(APPEND CMAKE_MODULE_PATH /path/to/volref/cmake)
#   include(volref)
#   volref_add_tests(
#     COMMAND $<TARGET_FILE:my-renderer> {scene} --out {output} --spp {spp}
#     CASES figures fog/forward      # families, cases, or patterns such as fog/*
#     SPP 256)
#
# Words in braces are those of `volref validate --run` ({scene}, {output}, {width}, {height}, {spp}, {seed},
# {case}, {step}, {rate}, {export:mitsuba}, {export:pbrt}, {export:bundle}). Further arguments:
#
#   SPP N           samples per pixel, {spp}               FORMAT EXT   of {output}: exr, pfm, npy or png
#   TIMEOUT SECONDS for the renderer                       PROFILE FILE conventions to judge by: vtk, anari, a file
#   PREFIX TEXT     of the names of tests [volref/]        SUITE DIR    in place of the suite within volref
#   LABELS TEXT...  of the tests [volref]                  REPORTS DIR  a page for each case below DIR
#   ACCEPT_CONVENTIONS   passes what is right under other conventions
#
# A test passes and fails as `volref validate` does, and is skipped where the image is too noisy to decide.
# Metrics and pictures are CTest's measurements.
# The program is VOLREF_PROGRAM, else `volref` on the search path. Needs CMake 3.21 and volref when configured.

cmake_minimum_required(VERSION 3.21)

function(volref_add_tests)
  cmake_parse_arguments(PARSE_ARGV 0 arg "ACCEPT_CONVENTIONS"
    "SPP;FORMAT;TIMEOUT;PROFILE;PREFIX;SUITE;REPORTS" "COMMAND;CASES;LABELS")
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
    set(suite --suite "${folder}")
  endif()
  execute_process(
    COMMAND "${VOLREF_PROGRAM}" list ${arg_CASES} ${suite} --json
    WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}"
    OUTPUT_VARIABLE listed ERROR_VARIABLE said RESULT_VARIABLE exit_code)
  if(NOT exit_code EQUAL 0)
    message(FATAL_ERROR "volref_add_tests: ${said}")
  endif()

  # One word for --run, in which volref reads words as a shell does.
  set(words)
  foreach(word IN LISTS arg_COMMAND)
    string(REPLACE "'" "'\\''" word "${word}")
    list(APPEND words "'${word}'")
  endforeach()
  list(JOIN words " " command)

  set(options)
  foreach(pair "SPP|--spp" "FORMAT|--format" "TIMEOUT|--timeout" "PROFILE|--as")
    string(REPLACE "|" ";" pair "${pair}")
    list(GET pair 0 name)
    list(GET pair 1 flag)
    if(DEFINED arg_${name})
      list(APPEND options ${flag} "${arg_${name}}")
    endif()
  endforeach()
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
      set(report --report "${folder}/${case}")
    endif()
    set(test "${arg_PREFIX}${case}")
    add_test(NAME "${test}"
      COMMAND "${VOLREF_PROGRAM}" validate "${case}" --run "${command}" ${options} ${suite} ${report}
        --ctest "${CMAKE_CURRENT_BINARY_DIR}/volref-pictures"
      WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
    # 5: nothing was compared, or the image is too noisy to decide.
    set_tests_properties("${test}" PROPERTIES SKIP_RETURN_CODE 5 LABELS "${arg_LABELS}")
  endforeach()
endfunction()
