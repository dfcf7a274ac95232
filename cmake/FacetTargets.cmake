# How facet's targets are made: one static library a folder of src/, one
# executable a program of apps/, one test executable a folder of tests/.

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

add_library(facet_options INTERFACE)
target_compile_features(facet_options INTERFACE cxx_std_17)
target_compile_options(facet_options INTERFACE -Wall -Wextra -Wshadow)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # OpenMesh and Eigen raise these from inside their inlined headers.
  target_compile_options(facet_options INTERFACE -Wno-maybe-uninitialized)
endif()
if(FACET_WERROR)
  target_compile_options(facet_options INTERFACE -Werror)
endif()
if(FACET_SANITIZE)
  string(REPLACE ";" "," facet_sanitizers "${FACET_SANITIZE}")
  add_compile_options(-fsanitize=${facet_sanitizers} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${facet_sanitizers})
endif()

# facet_library(NAME [SOURCES ...] [DEPENDS ...])
# A layer. Without sources it is header-only.
function(facet_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  if(ARG_SOURCES)
    add_library(${name} STATIC ${ARG_SOURCES})
    target_link_libraries(${name} PRIVATE facet_options PUBLIC ${ARG_DEPENDS})
    target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR}/src)
    target_compile_features(${name} PUBLIC cxx_std_17)
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE ${ARG_DEPENDS})
    target_include_directories(${name} INTERFACE ${PROJECT_SOURCE_DIR}/src)
    target_compile_features(${name} INTERFACE cxx_std_17)
  endif()
endfunction()

# facet_test(NAME LABEL label SOURCES ... [DEPENDS ...] [TIMEOUT seconds])
# One gtest executable, one ctest entry per TEST.
function(facet_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;DEPENDS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE facet_options ${ARG_DEPENDS}
                                        facet_test_support)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_definitions(${name} PRIVATE
                             FACET_DATA_DIR="${FACET_DATA_DIR}")
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60
                       PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
endfunction()
