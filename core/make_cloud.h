// New trees that are opened as soon as they are made: from any reader, or from a cloud that is open. An Error that
// is_done() says that the new tree was made, but may not survive a loss of power, or cannot be opened.
#pragma once

#include "pcm/build/builder.h"
#include "pcm/cloud/affine.h"
#include "pcm/io/reader.h"
#include "pcm/point_cloud.h"

#include <filesystem>
#include <memory>

namespace pcm {

// A new tree of all points of a reader, opened. Errors: those of build_tree() (build/builder.h).
std::shared_ptr<PointCloud> create_cloud(const std::filesystem::path& path, PointReader& points,
                                         const BuildOptions& build = {}, const L2Options& cache = {},
                                         Access access = Access::write);

// The cloud moved, turned or scaled, as a new tree, opened for reading; changes to the cloud are flushed first. Where
// the map only stretches and shifts along the axes, positions keep their integers on a mapped grid; else they
// are rounded by less than their own last bit. io/pipe/transformed_reader.h says what happens to attributes. Errors:
// those of build_tree() and PointCloud::flush(), and Error(invalid_argument) for a map that flattens space.
std::shared_ptr<PointCloud> transform_cloud(PointCloud& cloud, const Affine& map, const std::filesystem::path& path,
                                            const BuildOptions& build = {}, const L2Options& cache = {});

// The cloud as a tree of another name, in moments (update/clone.h): the data files are shared where the file system
// allows. Changes to the cloud are flushed first. Throws Error(exists) when there is something of that name, and what
// PointCloud::flush() and the file system throw.
void save_cloud(PointCloud& cloud, const std::filesystem::path& path);

}  // namespace pcm
