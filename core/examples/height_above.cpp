// Adds an attribute with every point's height above a level to a tree, and reads it back, within a given amount of
// memory for a tree of any size:
//   height_above city.pct 92.5 256
#include "pcm/point_cloud.h"

#include <cstdio>
#include <string>

int main(int argc, char** argv)
try {
    if (argc != 4) return std::fprintf(stderr, "usage: height_above TREE LEVEL MEGABYTES\n"), 2;
    const double level = std::stod(argv[2]);
    pcm::L2Options cache;
    cache.capacity_bytes = std::stoull(argv[3]) << 20;

    auto cloud = pcm::PointCloud::open(argv[1], cache, pcm::Access::write);
    if (!cloud->info().schema.find("height")) cloud->add_attribute({"height", pcm::ScalarType::f32});
    pcm::Query query;
    query.attributes = {"height"};
    auto changes = cloud->edit(query);
    for (pcm::EditView view; changes.getNextData(view); view.mark_written())
        for (std::size_t i = 0; i < view.size(); ++i) view.set(i, 0, float(view.position(i)[2] - level));
    cloud->close();  // commits the changes atomically

    cloud = pcm::PointCloud::open(argv[1], cache);
    auto cursor = cloud->points(query);
    std::size_t points = 0, wrong = 0;
    for (pcm::PointView view; cursor.getNextData(view); points += view.size())
        for (std::size_t i = 0; i < view.size(); ++i) wrong += view.value(i, 0) != float(view.position(i)[2] - level);
    std::printf("%zu points, %zu of them have another height\n", points, wrong);
    return wrong ? 1 : 0;
} catch (const std::exception& error) {
    return std::fprintf(stderr, "height_above: %s\n", error.what()), 1;
}
