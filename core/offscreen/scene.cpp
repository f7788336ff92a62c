#include "pcm/offscreen/scene.h"

#include "pcm/system/error.h"
#include "pcm/system/tree_folder.h"
#include "pcm/system/url.h"

#include <set>
#include <string>

namespace pcm {

OffscreenScene::OffscreenScene(const std::vector<std::filesystem::path>& trees, const L1Options& l1,
                               const L2Options& l2)
    : l1_(std::make_shared<L1Cache>(l1)), renderer_(l1_)
{
    if (trees.empty()) throw Error(ErrorCode::invalid_argument, {}, "there is no tree to draw");
    std::set<std::filesystem::path> named;
    for (const std::filesystem::path& tree : trees) {
        std::error_code error;
        std::filesystem::path canonical = tree_folder_of(tree);
        if (!is_url(canonical)) canonical = std::filesystem::canonical(canonical, error);
        if (!error && !named.insert(canonical).second)
            throw Error(ErrorCode::invalid_argument, tree, "this tree is named twice");
        clouds_.push_back(PointCloud::open(tree, l2));
        box_.extend(clouds_.back()->info().bounds());
    }
    if (box_.empty())
        throw Error(ErrorCode::invalid_argument, trees.front(), "there is nothing to draw: the tree has no points");
    origin_ = box_.centre();
    for (const auto& cloud : clouds_) {
        drawn_.push_back(std::make_unique<DrawnCloud>(cloud, l1_));
        drawn_.back()->set_wake([this] {
            {
                const std::lock_guard<std::mutex> lock(mutex_);
                arrived_ = true;
            }
            arrival_.notify_one();
        });
    }
}

OffscreenScene::~OffscreenScene()
{
    for (const auto& cloud : drawn_) {
        cloud->set_wake({});
        cloud->release();
    }
    picture_.release();
    renderer_.release();
    l1_->release();
}

FrameReport OffscreenScene::draw(const Camera& view, const CloudStyle& style, const RenderOptions& options)
{
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        arrived_ = false;
    }
    std::vector<SceneItem> items;
    for (const auto& cloud : drawn_) {
        SceneItem item;
        item.cloud = cloud.get();
        item.origin = origin_;
        item.style = style;
        item.clips = clips_;
        items.push_back(item);
    }
    return renderer_.draw(picture_, view, items, options);
}

void OffscreenScene::wait(std::chrono::milliseconds most)
{
    std::unique_lock<std::mutex> lock(mutex_);
    arrival_.wait_for(lock, most, [this] { return arrived_; });
}

std::uint64_t OffscreenScene::loaded_bytes() const
{
    std::uint64_t bytes = 0;
    for (const auto& cloud : clouds_) bytes += cloud->cache().statistics().loaded_bytes;
    return bytes;
}

}  // namespace pcm
