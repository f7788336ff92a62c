// Our voxel grid for bench/voxels/run.py: see voxel_files.h. For a tree, out of core, all attributes included; for a
// file of positions, the kernel in memory.
#include "bench/voxels/voxel_files.h"

#include "pcm/filter/voxel_grid.h"
#include "pcm/filter/voxel_groups.h"

namespace {

using namespace pcm;
using namespace pcm::bench;

std::vector<double> interleaved(const Positions& points)
{
    std::vector<double> all;
    for (const Vec3d& p : points) all.insert(all.end(), p.begin(), p.end());
    return all;
}

void of_tree(double size, unsigned threads, const std::string& path, const std::string& result)
{
    VoxelGridOptions options;
    options.voxels.size = size;
    options.threads = threads;
    Positions found;
    const Stopwatch watch;
    VoxelGridReader grid(Tree::open(path), options);
    for (PointBatch batch; grid.read(batch, default_batch_points);)
        for (std::size_t i = 0; i < batch.size; ++i)
            found.push_back({batch.xyz[0][i], batch.xyz[1][i], batch.xyz[2][i]});
    watch.print();
    write_doubles(result, interleaved(found));
}

void of_positions(double size, const std::string& path, const std::string& result)
{
    Positions points;
    {
        const std::vector<double> xyz = read_doubles(path);
        points.reserve(xyz.size() / 3);
        for (std::size_t i = 0; i < xyz.size(); i += 3) points.push_back({xyz[i], xyz[i + 1], xyz[i + 2]});
    }
    const Stopwatch watch;
    VoxelSort scratch;
    PointGroups groups;
    const VoxelLattice lattice{size, {0, 0, 0}};
    group_by_voxel(points, lattice, scratch, groups);
    const Positions found = centroids(points, groups);
    watch.print();
    write_doubles(result, interleaved(found));
}

}  // namespace

int main(int argc, char** argv)
{
    return run_voxels(argc, argv,
                      [](double size, unsigned threads, const std::string& path, const std::string& result) {
                          if (is_tree(path))
                              of_tree(size, threads, path, result);
                          else
                              of_positions(size, path, result);
                      });
}
