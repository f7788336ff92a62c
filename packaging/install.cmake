# What `cmake --install` puts where, for those who build on the library: the libraries, their public headers, and the
# package that find_package(pcm) reads. The command and the plugins say so themselves, beside their targets.
#
# Components of the install: library (this file), command, meshlab.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/pcm)

# The public headers and all that they include; tests/install compiles each of them by itself out of the install.
set(public_headers
  edit_cursor.h point_cloud.h
  io/reader.h io/pipe/grid_choice.h cloud/selection.h io/text/text_layout.h io/pipe/selected_reader.h io/pipe/transformed_reader.h io/writer.h
  bpc/bpc_array.h bpc/chunk.h bpc/chunk_identity.h bpc/chunk_index.h bpc/cloud_block.h bpc/commit_record.h
  tree/chunk_size.h tree/tree.h tree/tree_reader.h tree/selected_nodes.h build/builder.h tree/verify.h tree/verify_levels.h
  update/append.h update/compact.h update/erase.h update/repair.h
  query/estimate.h query/nearest.h query/point_blocks.h query/query.h threads/task_pool.h query/read_rates.h
  convert/convert.h
  cache/chunk_store.h cache/l2_cache.h cache/load_times.h)
file(GLOB wholly_public RELATIVE ${PROJECT_SOURCE_DIR}/core CONFIGURE_DEPENDS
     ${PROJECT_SOURCE_DIR}/core/cloud/*.h ${PROJECT_SOURCE_DIR}/core/system/*.h ${PROJECT_SOURCE_DIR}/core/view/*.h)
set(gl_headers gl/renderer.h gl/splat_style.h gl/vertex_format.h gl/vertex_groups.h gl/gpu_cursor.h gl/l1_cache.h gl/l1_table.h)

function(install_public_headers)
  foreach(header ${ARGN})
    get_filename_component(folder ${header} DIRECTORY)
    install(FILES ${PROJECT_SOURCE_DIR}/core/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pcm/${folder}
            COMPONENT library)
  endforeach()
endfunction()

# A component a target, so that an install without OpenGL is whole, and find_package can say what is missing.
function(install_component component target)
  install_public_headers(${ARGN})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${component})
  install(TARGETS ${target} EXPORT pcm_${component}
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
  install(EXPORT pcm_${component} NAMESPACE pcm:: FILE pcm-${component}.cmake DESTINATION ${package_folder}
          COMPONENT library)
endfunction()

install_component(core pcm_core ${public_headers} ${wholly_public})
if(TARGET pcm_gl)
  install_component(gl pcm_gl ${gl_headers})
endif()
if(TARGET pcm_offscreen)
  install_component(offscreen pcm_offscreen offscreen/image.h offscreen/offscreen.h offscreen/scene.h)
endif()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/cmake/pcmConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/packaging/pcmConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/packaging/pcmConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/packaging/pcmConfig.cmake ${PROJECT_BINARY_DIR}/packaging/pcmConfigVersion.cmake
        DESTINATION ${package_folder} COMPONENT library)
