# Sources compiled in groups: a header or a template that several of them use is compiled once for all. With the
# precompiled header below it takes half the processor seconds off a build from nothing.
#
# PCM_GROUP_SOURCES: the presets that packaging/run and packaging/test build switch it on. The preset dev has neither groups
# nor precompiled headers: there each source shows that it includes what it uses.
option(PCM_GROUP_SOURCES "Compile the sources of a folder in groups" OFF)
# Larger groups take fewer processor seconds (core/ops: 140, 104, 92 at 1, 2, 4), but after a change of one source all of its group is
# compiled. The preset release has 2; those of the sanitizers, which are built from nothing more often than again, 4.
set(PCM_GROUP_SCALE 1 CACHE STRING "The groups are this many times as large")

# pcm_group_sources(TARGET [SIZE 4] SOURCE...): groups of sources that lie next to each other in one folder, by the alphabet. Names
# in the unnamed namespaces of a folder's sources must therefore differ. A source that has options of its own, or the property
# SKIP_UNITY_BUILD_INCLUSION or SKIP_PRECOMPILE_HEADERS, is compiled alone.
function(pcm_group_sources target)
  cmake_parse_arguments(PARSE_ARGV 1 group "" SIZE "")
  if(NOT group_SIZE)
    set(group_SIZE 4)
  endif()
  math(EXPR group_SIZE "${group_SIZE} * ${PCM_GROUP_SCALE}")
  set(sources ${group_UNPARSED_ARGUMENTS})
  foreach(source ${sources})
    get_source_file_property(options ${source} COMPILE_OPTIONS)
    if(options)
      set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)  # it is made with other options
    endif()
  endforeach()
  if(NOT PCM_GROUP_SOURCES)
    return()
  endif()
  foreach(source ${sources})
    get_source_file_property(options ${source} COMPILE_OPTIONS)
    get_source_file_property(alone ${source} SKIP_UNITY_BUILD_INCLUSION)
    get_source_file_property(own_headers ${source} SKIP_PRECOMPILE_HEADERS)
    if(options OR alone OR own_headers OR NOT source MATCHES "[.]cpp$")
      continue()
    endif()
    cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE path)
    cmake_path(GET path PARENT_PATH folder)
    string(REPLACE "/" "_" folder "${folder}")
    list(APPEND sources_of_${folder} ${source})
    list(LENGTH sources_of_${folder} n)
    math(EXPR group "(${n} - 1) / ${group_SIZE}")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder}_${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()
