#include "pcm/make_cloud.h"

#include "pcm/io/pipe/transformed_reader.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_reader.h"
#include "pcm/update/clone.h"

#include <optional>
#include <stdexcept>

namespace pcm {
namespace {

// Throws the warnings of steps that led to a new tree.
void raise(const std::filesystem::path& path, const Outcome& outcome)
{
    if (!outcome.warnings.empty())
        throw Error::after(path, "the tree was made", std::runtime_error(outcome.warnings.front()));
}

std::shared_ptr<PointCloud> open_made(const std::filesystem::path& path, const L2Options& cache, Access access)
{
    try {
        return PointCloud::open(path, cache, access);
    } catch (const std::exception& error) {
        throw Error::after(path, "the tree was made", error);
    }
}

}  // namespace

std::shared_ptr<PointCloud> create_cloud(const std::filesystem::path& path, PointReader& points,
                                         const BuildOptions& build, const L2Options& cache, Access access)
{
    raise(path, build_tree(points, {}, path, build).outcome);
    return open_made(path, cache, access);
}

std::shared_ptr<PointCloud> transform_cloud(PointCloud& cloud, const Affine& map, const std::filesystem::path& path,
                                            const BuildOptions& build, const L2Options& cache)
{
    Outcome outcome;
    run_last_step(outcome, [&] { cloud.flush(); });
    const std::shared_ptr<const Tree> from = cloud.tree();
    TransformedReader points(std::make_unique<TreeReader>(from, std::nullopt, Selection()), map);
    raise(path, build_tree(points, from->info().sources, path, build).outcome);
    raise(path, outcome);
    return open_made(path, cache, Access::read);
}

void save_cloud(PointCloud& cloud, const std::filesystem::path& path)
{
    Outcome outcome;
    run_last_step(outcome, [&] { cloud.flush(); });
    clone_tree(cloud.tree()->folder(), path);
    raise(path, outcome);
}

}  // namespace pcm
