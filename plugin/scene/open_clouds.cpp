#include "plugin/scene/open_clouds.h"

#include "pcm/system/tree_folder.h"
#include "pcm/threads/thread_count.h"

#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <utility>

namespace pcm::host {
namespace {

std::shared_ptr<PointCloud>& opened_already()
{
    static auto& cloud = *new std::shared_ptr<PointCloud>;
    return cloud;
}

}  // namespace

OpenedAlready::OpenedAlready(std::shared_ptr<PointCloud> cloud) { opened_already() = std::move(cloud); }
OpenedAlready::~OpenedAlready() { opened_already().reset(); }

L2Options cache_of_opened()
{
    L2Options cache;
    cache.threads = std::clamp(thread_count(0) / 2, 1u, 4u);
    return cache;
}

std::shared_ptr<PointCloud> open_cloud(const std::filesystem::path& path)
{
    // The folder; device, inode and time of its index.
    using Key = std::tuple<std::string, std::uint64_t, std::uint64_t, std::int64_t>;
    static auto& clouds = *new std::map<Key, std::weak_ptr<PointCloud>>;

    if (const auto& cloud = opened_already(); cloud && same_tree_folder(cloud->tree()->folder(), path)) return cloud;
    const L2Options cache = cache_of_opened();
    for (auto it = clouds.begin(); it != clouds.end();) it = it->second.expired() ? clouds.erase(it) : std::next(it);
    std::error_code ignored;
    const std::string canonical = std::filesystem::canonical(tree_folder_of(path), ignored).string();
    struct stat index {};
    if (canonical.empty() || stat((canonical + "/" + index_file_name).c_str(), &index) != 0)
        return PointCloud::open(path, cache);  // throws the error that fits
    const Key key(canonical, index.st_dev, index.st_ino,
                  std::int64_t(index.st_mtim.tv_sec) * 1'000'000'000 + index.st_mtim.tv_nsec);
    if (const auto found = clouds.find(key); found != clouds.end())
        if (auto cloud = found->second.lock()) return cloud;
    auto cloud = PointCloud::open(canonical, cache);
    clouds[key] = cloud;
    return cloud;
}

}  // namespace pcm::host
