# What `cmake --install` puts where for programs that build on the library: the libraries, their public headers, and the
# package that find_package(pcm) reads. The command and the plugins are installed from the folders of their targets.
#
# Components of the install: library (this file), command, meshlab.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/pcm)

# The headers that a program may include, and below them those that these include in turn: they are installed too, but
# not for a program to name. tests/install holds the lists against the includes and compiles each header by itself.
set(public_headers
  point_cloud.h make_cloud.h
  query/query.h query/point_cursor.h query/edit_cursor.h query/estimate.h query/nearest.h query/named_points.h query/point_set.h cache/l2_cache.h knn/neighbourhoods.h
  build/builder.h convert/convert.h update/append.h update/compact.h update/erase.h update/repair.h update/target.h
  filter/neighbour_attributes.h filter/outliers.h filter/voxel_grid.h filter/subsample.h filter/merge.h
  tree/tree.h tree/tree_reader.h tree/tree_reads.h tree/verify.h tree/verify_levels.h bpc/bpc_array.h
  io/reader.h io/writer.h io/pipe/grid_choice.h io/pipe/selected_reader.h io/pipe/transformed_reader.h
  pick/pick_ray.h pick/point_picker.h pick/describe_point.h align/rigid_fit.h
  shapes/primitive.h shapes/shape.h shapes/fitted_shape.h fit/shape_fit.h shapes/bounds.h fit/fit_points.h cad/primitive_files.h shapes/primitive_list.h
  place/fit_at.h place/reached_from.h detect/detect.h
  measure/measure.h measure/measure_list.h measure/measure_export.h measure/profile.h measure/volume.h measure/snap.h
  select/select_points.h select/front_points.h select/grow.h filter/set_changes.h filter/set_points.h
  cloud/affine.h cloud/attribute.h cloud/clip.h cloud/condition.h cloud/geometry.h cloud/metadata.h cloud/point_batch.h cloud/region.h
  cloud/selection.h cloud/vector.h
  system/error.h system/progress.h
  view/camera.h view/camera_path.h view/clearance.h view/first_person.h view/frustum.h view/level_of_detail.h view/motion.h)
set(reachable_headers
  bpc/chunk.h bpc/chunk_identity.h bpc/chunk_index.h bpc/cloud_block.h bpc/commit_record.h cache/chunk_store.h
  cache/load_times.h cloud/matrix.h cloud/nearest_float.h cloud/polygon.h io/crs/coordinate_system.h view/point_shapes.h view/point_sizes.h filter/filter_report.h filter/normal_orientation.h
  filter/point_values.h filter/result_tree.h filter/voxel_lattice.h knn/held_chunks.h knn/point_blocks.h knn/point_search.h
  place/departure.h place/grow_shape.h place/near_points.h place/swept_part.h shapes/shape_kinds.h shapes/shape_traits.h shapes/station_facts.h cloud/numbers.h
  io/text/text_layout.h system/byte_source.h system/file.h system/page_allocator.h
  system/tree_folder.h lists/undo_list.h tree/chunk_size.h tree/node.h tree/node_table.h tree/selected_nodes.h tree/source_rounding.h threads/task_pool.h)
set(public_gl_headers gl/draw/renderer.h gl/style/splat_style.h gl/compute/gpu_cursor.h gl/compute/gpu_radii.h gl/l1/l1_cache.h)
set(reachable_gl_headers gl/tuning.h gl/style/colour_modes.h gl/l1/chunk_vertices.h gl/l1/l1_table.h gl/style/splat_modes.h gl/l1/vertex_format.h gl/l1/vertex_groups.h view/colour_ramps.h
  view/point_colours.h view/value_range.h)
set(public_offscreen_headers offscreen/image.h offscreen/offscreen.h offscreen/scene.h)

function(install_headers)
  foreach(header ${ARGN})
    get_filename_component(folder ${header} DIRECTORY)
    install(FILES ${PROJECT_SOURCE_DIR}/core/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pcm/${folder}
            COMPONENT library)
  endforeach()
endfunction()

# A component a target, so that an install without OpenGL is whole, and find_package can say what is missing.
function(install_component component target)
  install_headers(${ARGN})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${component})
  install(TARGETS ${target} EXPORT pcm_${component}
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
  install(EXPORT pcm_${component} NAMESPACE pcm:: FILE pcm-${component}.cmake DESTINATION ${package_folder}
          COMPONENT library)
endfunction()

install_component(core pcm_core ${public_headers} ${reachable_headers})
if(TARGET pcm_gl)
  install_component(gl pcm_gl ${public_gl_headers} ${reachable_gl_headers})
endif()
if(TARGET pcm_offscreen)
  install_component(offscreen pcm_offscreen ${public_offscreen_headers})
endif()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/cmake/pcmConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/packaging/pcmConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/packaging/pcmConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/packaging/pcmConfig.cmake ${PROJECT_BINARY_DIR}/packaging/pcmConfigVersion.cmake
        DESTINATION ${package_folder} COMPONENT library)

# cmake strips programs and shared libraries itself. Rust's standard library in the decoders' archive carries its code once more, as
# LLVM's, for linkers that optimise across languages: two thirds of the archive.
if(PCM_STRIP_INSTALL AND CMAKE_STRIP AND CMAKE_OBJCOPY)
  install(CODE "
file(GLOB libraries \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/libpcm*.a\")
execute_process(COMMAND \"${CMAKE_STRIP}\" --strip-debug \${libraries} COMMAND_ERROR_IS_FATAL ANY)
foreach(library IN LISTS libraries)
  execute_process(COMMAND \"${CMAKE_OBJCOPY}\" -R .llvmbc -R .llvmcmd \${library} COMMAND_ERROR_IS_FATAL ANY)
endforeach()" COMPONENT library)
endif()
