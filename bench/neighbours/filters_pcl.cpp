// PCL's normals and outliers for bench/neighbours/run.py: see filter_files.h.
#include "bench/neighbours/filter_files.h"

#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/search/kdtree.h>

namespace {

using namespace pcm::bench;

FilterResult run(const FilterRequest& request, const std::vector<double>& xyz)
{
    const auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
    for (std::size_t i = 0; i < xyz.size(); i += 3)
        cloud->emplace_back(static_cast<float>(xyz[i]), static_cast<float>(xyz[i + 1]), static_cast<float>(xyz[i + 2]));
    FilterResult result;
    if (request.filter == "normals") {
        pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(static_cast<unsigned>(request.threads));
        estimation.setInputCloud(cloud);
        estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
        estimation.setKSearch(request.neighbours + 1);  // the point itself is one of them
        pcl::PointCloud<pcl::Normal> normals;
        estimation.compute(normals);
        for (const pcl::Normal& n : normals)
            result.normals.insert(result.normals.end(), {n.normal_x, n.normal_y, n.normal_z});
        return result;
    }
    pcl::StatisticalOutlierRemoval<pcl::PointXYZ> removal(true);
    removal.setInputCloud(cloud);
    removal.setMeanK(request.neighbours);
    removal.setStddevMulThresh(request.sigmas);
    std::vector<int> kept;
    removal.filter(kept);
    result.outliers.assign(xyz.size() / 3, 1);
    for (const int i : kept) result.outliers[static_cast<std::size_t>(i)] = 0;
    return result;
}

}  // namespace

int main(int argc, char** argv) { return pcm::bench::run_filter(argc, argv, run); }
