cmake_minimum_required(VERSION 3.22)

# Every key of the JSON files and every column of trace.csv that the code writes
# must be described in docs/formats.md, as `key`. Writing a new field without
# telling its reader breaks this.
set(sources
    src/pipeline/export_stage.cc
    src/pipeline/reconstruct.cc
    src/pipeline/report.cc
    src/pipeline/stage_clock.cc
    src/eval/evaluation_report.cc
    src/ablate/run_result.cc
    apps/evaluate.cc)

file(READ ${ROOT}/docs/formats.md documentation)
set(num_keys 0)
function(require key source)
  string(FIND "${documentation}" "`${key}`" at)
  if(at EQUAL -1)
    message(SEND_ERROR "docs/formats.md does not describe `${key}` of ${source}")
  endif()
endfunction()

foreach(source IN LISTS sources)
  file(READ ${ROOT}/${source} text)
  # {"key", value} of an initializer; name["key"] = value.
  string(REGEX MATCHALL "{\"[A-Za-z_]+\"," initializers "${text}")
  string(REGEX MATCHALL "\\[\"[A-Za-z_]+\"\\] =" assignments "${text}")
  string(REGEX REPLACE "[^A-Za-z_;]" "" keys "${initializers};${assignments}")
  list(REMOVE_DUPLICATES keys)
  list(REMOVE_ITEM keys "")
  foreach(key IN LISTS keys)
    require(${key} ${source})
    math(EXPR num_keys "${num_keys} + 1")
  endforeach()
endforeach()

file(READ ${ROOT}/src/schedule/run_schedule.cc text)
if(NOT text MATCHES "\"level,round,phase,[^;]*\\\\n\";")
  message(SEND_ERROR "the header of trace.csv was not found")
endif()
string(REGEX REPLACE "[\" \n]|\\\\n" "" columns "${CMAKE_MATCH_0}")
string(REPLACE ";" "" columns "${columns}")
string(REPLACE "," ";" columns "${columns}")
foreach(column IN LISTS columns)
  require(${column} trace.csv)
  math(EXPR num_keys "${num_keys} + 1")
endforeach()
if(num_keys LESS 100)
  message(SEND_ERROR "only ${num_keys} keys were found in the code")
endif()
message(STATUS "docs/formats.md describes all ${num_keys} keys")
