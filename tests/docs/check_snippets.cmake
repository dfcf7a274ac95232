cmake_minimum_required(VERSION 3.22)

# Code of the documentation that claims to be that of a source,
#
#   <!-- from src/costs/axis_plane.h -->
#   ```cpp
#   ...
#   ```
#
# must be in it, letter by letter. Changing one without the other breaks this.
set(mark "<!-- from ")
set(num_snippets 0)
file(GLOB pages ${ROOT}/*.md ${ROOT}/docs/*.md)
foreach(page IN LISTS pages)
  file(READ ${page} rest)
  string(FIND "${rest}" "${mark}" at)
  while(at GREATER_EQUAL 0)
    string(LENGTH "${mark}" length)
    math(EXPR at "${at} + ${length}")
    string(SUBSTRING "${rest}" ${at} -1 rest)
    string(FIND "${rest}" " -->\n```cpp\n" name_end)
    if(name_end LESS 0)
      message(FATAL_ERROR "${page}: no code follows '${mark}...'")
    endif()
    string(SUBSTRING "${rest}" 0 ${name_end} source)
    math(EXPR code_begin "${name_end} + 12")
    string(SUBSTRING "${rest}" ${code_begin} -1 rest)
    string(FIND "${rest}" "```" code_end)
    string(SUBSTRING "${rest}" 0 ${code_end} code)
    file(READ ${ROOT}/${source} text)
    string(FIND "${text}" "${code}" found)
    if(found LESS 0)
      message(SEND_ERROR "${page}: ${source} does not hold\n${code}")
    endif()
    math(EXPR num_snippets "${num_snippets} + 1")
    string(FIND "${rest}" "${mark}" at)
  endwhile()
endforeach()
if(num_snippets LESS 3)
  message(SEND_ERROR "only ${num_snippets} snippets found: the check is blind")
endif()
