// The number of points of a tree in a box, and their mean height:
//   mean_height city.pct 500000 4800000 0  500100 4800100 50
#include "pcm/point_cloud.h"

#include <cstdio>
#include <string>

int main(int argc, char** argv)
try {
    if (argc != 8) return std::fprintf(stderr, "usage: mean_height TREE MIN_X MIN_Y MIN_Z MAX_X MAX_Y MAX_Z\n"), 2;
    const auto number = [&](int i) { return std::stod(argv[i]); };

    pcm::Query query;
    query.box = pcm::Box3d{{number(2), number(3), number(4)}, {number(5), number(6), number(7)}};
    auto cloud = pcm::PointCloud::open(argv[1]);
    auto cursor = cloud->points(query);
    std::size_t count = 0;
    double sum = 0;
    for (pcm::PointView view; cursor.getNextData(view); count += view.size())
        for (std::size_t i = 0; i < view.size(); ++i) sum += view.position(i)[2];
    std::printf("%zu points, mean height %.6f\n", count, count ? sum / double(count) : 0.0);
} catch (const std::exception& error) {
    return std::fprintf(stderr, "mean_height: %s\n", error.what()), 1;
}
