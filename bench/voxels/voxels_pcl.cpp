// PCL's VoxelGrid for bench/voxels/run.py: see voxel_files.h. It has one thread, and floats.
#include "bench/voxels/voxel_files.h"

#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>

int main(int argc, char** argv)
{
    using namespace pcm::bench;
    return run_voxels(argc, argv, [](double size, unsigned, const std::string& path, const std::string& result) {
        const auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
        {
            const std::vector<double> xyz = read_doubles(path);
            cloud->reserve(xyz.size() / 3);
            for (std::size_t i = 0; i < xyz.size(); i += 3)
                cloud->emplace_back(static_cast<float>(xyz[i]), static_cast<float>(xyz[i + 1]),
                                    static_cast<float>(xyz[i + 2]));
        }
        pcl::PointCloud<pcl::PointXYZ> found;
        const Stopwatch watch;
        pcl::VoxelGrid<pcl::PointXYZ> grid;
        grid.setInputCloud(cloud);
        const auto leaf = static_cast<float>(size);
        grid.setLeafSize(leaf, leaf, leaf);
        grid.filter(found);
        watch.print();
        std::vector<double> all;
        for (const pcl::PointXYZ& p : found)
            all.insert(all.end(), {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)});
        write_doubles(result, all);
    });
}
