// One point for each voxel that has points: the cloud made even, and smaller.
#pragma once

#include "pcm/filter/result_tree.h"
#include "pcm/filter/voxel_lattice.h"
#include "pcm/io/reader.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace pcm {

// What stands for the points of a voxel.
enum class VoxelPoint {
    centroid,  // the mean of their positions, with the attributes of all of them (filter/combined_attributes.h)
    nearest,   // the one of them that is nearest to the centroid, as it is
};

struct VoxelGridOptions {
    VoxelLattice voxels;
    VoxelPoint point = VoxelPoint::centroid;
    bool count = false;  // add an attribute `point_count`, u32: the number of points in the voxel
    // Attributes that are combined otherwise than their names imply; for centroids.
    std::vector<std::string> by_majority, by_mean;
    std::uint64_t memory_bytes = std::uint64_t(256) << 20;  // memory of the reader
    unsigned threads = 0;                                   // 0: one per processor
};

inline constexpr const char* point_count_name = "point_count";

// The voxel grid of a tree, as a cloud that is read. It has exactly one point for each voxel that has points.
//
// Centroids are doubles, off by half a last bit (filter/voxel_groups.h): 5e-10 m for coordinates of millions of metres.
// A tree of doubles holds them so. Points taken as they are keep their grid. Metadata stay, the system of
// coordinates among them.
//
// Space is divided into boxes of whole voxels with about as many points as the memory allows; each is read by itself,
// by one of the threads, from all levels and parts of the tree, and a box that is a single voxel is summed up in
// passing. So memory is bounded however the points lie. Only the tree and the memory decide the order of the result,
// and the result but for the last bits of sums of floating-point values. One thread calls.
class VoxelGridReader final : public PointReader {
public:
    // Throws what check_voxels() and combinations_of() throw.
    VoxelGridReader(std::shared_ptr<const Tree> tree, const VoxelGridOptions& options);
    ~VoxelGridReader() override;

    // The number of points is an upper bound until all are read.
    const FileInfo& info() const override;
    bool read(PointBatch& batch, std::size_t max_points) override;
    double fraction_read() const override;

    std::uint64_t points_in() const;   // points of the tree, combined so far
    std::uint64_t points_out() const;  // voxels so far
    // Number of points of the fullest voxel so far.
    std::uint64_t most_in_one() const;

private:
    class Work;
    std::unique_ptr<Work> work_;
};

// What a voxel grid of such points is: its attributes and type of positions, and what a user should know.
FileInfo info_of_voxels(FileInfo from, const VoxelGridOptions& options);

struct VoxelGridReport {
    BuildReport build;              // points_in: of the source; points_out: voxels
    Box3d box;                      // around the points of the source
    std::uint64_t most_in_one = 0;  // number of points of the fullest voxel
};

// The voxel grid of a tree as a tree. `options.memory_bytes` and `options.threads` have no meaning here. Throws what
// VoxelGridReader and build_result() throw.
VoxelGridReport voxel_grid(const std::filesystem::path& tree, const VoxelGridOptions& options,
                           const ResultOptions& result);

}  // namespace pcm
