#include "pcm/make_cloud.h"

#include "pcm/io/pipe/transformed_reader.h"
#include "pcm/tree/tree_reader.h"
#include "pcm/update/clone.h"

#include <optional>

namespace pcm {

std::shared_ptr<PointCloud> create_cloud(const std::filesystem::path& path, PointReader& points,
                                         const BuildOptions& build, const L2Options& cache, Access access)
{
    build_tree(points, {}, path, build);
    return PointCloud::open(path, cache, access);
}

std::shared_ptr<PointCloud> transform_cloud(PointCloud& cloud, const Affine& map, const std::filesystem::path& path,
                                            const BuildOptions& build, const L2Options& cache)
{
    cloud.flush();
    const std::shared_ptr<const Tree> from = cloud.tree();
    TransformedReader points(std::make_unique<TreeReader>(from, std::nullopt, Selection()), map);
    build_tree(points, from->info().sources, path, build);
    return PointCloud::open(path, cache);
}

void save_cloud(PointCloud& cloud, const std::filesystem::path& path)
{
    cloud.flush();
    clone_tree(cloud.tree()->folder(), path);
}

}  // namespace pcm
