#include "plugin/scene/replaced_trees.h"

#include "plugin/scene/open_clouds.h"
#include "plugin/scene/proxy.h"
#include "plugin/scene/scene.h"

#include "pcm/remote/remote_object.h"
#include "pcm/system/error.h"
#include "pcm/system/url.h"

#include <utility>

namespace pcm::host {
namespace {

constexpr qint64 ask_again_ms = 5000;

}  // namespace

bool takes_the_place(const TreeInfo& now, const TreeInfo& before, const std::string& error)
{
    return is_replaced(error) || now.content_hash != before.content_hash || now.generation != before.generation;
}

ReplacedTrees::ReplacedTrees(Scene& scene)
    : QObject(&scene), scene_(scene), worker_("a tree on a server is being opened again")
{
}

void ReplacedTrees::could_not_load(const Tree& tree, const std::string& error)
{
    if (!is_url(tree.folder()) || is_unreachable(error) || worker_.is_running() || scene_.is_busy()) return;
    if (asked_.isValid() && asked_.elapsed() < ask_again_ms) return;
    asked_.start();
    const auto now = std::make_shared<std::shared_ptr<PointCloud>>();
    worker_.start(
        [now, folder = tree.folder(), before = tree.info(), error](const ProgressFunction&) {
            auto cloud = PointCloud::open(folder, cache_of_opened());
            if (!takes_the_place(cloud->info(), before, error)) return;
            make_proxy(*cloud, {0, 0, 0});  // what layers need is in the cache then
            *now = std::move(cloud);
        },
        [this, now](const std::exception_ptr&) {  // an error: there is no whole tree yet, and the view has its error
            if (*now) show(*now);
        });
}

void ReplacedTrees::show(const std::shared_ptr<PointCloud>& now)
{
    if (scene_.is_busy()) return;
    const OpenedAlready opened(now);
    const std::filesystem::path folder = now->tree()->folder();
    try {
        scene_.log(LogLevel::warning, "The tree at " + QString::fromStdString(folder.string()) +
                                          " has been replaced on its server, and is opened again.");
        for (const std::string& line : scene_.reload(folder))
            scene_.log(LogLevel::system, QString::fromStdString(line));
    } catch (const std::exception& error) {
        scene_.log(LogLevel::warning, QString::fromUtf8(error.what()));
    }
    scene_.repaint();
}

}  // namespace pcm::host
