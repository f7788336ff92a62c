#include "render/painter.h"

#include <QOpenGLContext>

#include <algorithm>
#include <map>
#include <utility>

namespace pcm::host {

namespace {

// Share groups are told apart by address; a dead group's entries have expired, so an address may come again.
std::map<const void*, std::weak_ptr<L1Cache>>& l1_of_groups()
{
    static std::map<const void*, std::weak_ptr<L1Cache>> map;
    return map;
}

std::map<std::pair<const void*, const PointCloud*>, std::weak_ptr<Painter>>& painters()
{
    static std::map<std::pair<const void*, const PointCloud*>, std::weak_ptr<Painter>> map;
    return map;
}

std::shared_ptr<L1Cache> l1_of_group(const void* group, std::uint64_t bytes)
{
    auto& map = l1_of_groups();
    for (auto it = map.begin(); it != map.end();) it = it->second.expired() ? map.erase(it) : std::next(it);
    auto l1 = map[group].lock();
    if (!l1 || l1->options().capacity_bytes != bytes) {
        L1Options options;
        options.capacity_bytes = bytes;
        l1 = std::make_shared<L1Cache>(options);
        map[group] = l1;  // painters of the former one notice, see is_current()
    }
    return l1;
}

}  // namespace

std::shared_ptr<Painter> Painter::of(const std::shared_ptr<PointCloud>& cloud, std::uint64_t l1_bytes)
{
    const void* const group = QOpenGLContext::currentContext()->shareGroup();
    auto& map = painters();
    for (auto it = map.begin(); it != map.end();) it = it->second.expired() ? map.erase(it) : std::next(it);
    const auto l1 = l1_of_group(group, l1_bytes);
    auto& slot = map[{group, cloud.get()}];
    if (auto painter = slot.lock())
        if (painter->l1_ == l1) return painter;
    const std::shared_ptr<Painter> painter(new Painter(cloud, l1, group));
    slot = painter;
    return painter;
}

Painter::Painter(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1, const void* share_group)
    : renderer_(std::make_unique<CloudRenderer>(std::move(cloud), l1)), l1_(std::move(l1)), share_group_(share_group)
{
    // Queued to this object's thread, the GUI's; what is queued dies with the object.
    renderer_->set_wake([this] { QMetaObject::invokeMethod(this, &Painter::wake_views, Qt::QueuedConnection); });
}

Painter::~Painter()
{
    renderer_.reset();  // first: no loader thread calls us from here on
}

void Painter::give_back(std::shared_ptr<Painter>& painter)
{
    if (painter && painter.use_count() == 1) {
        painter->renderer_->release();
        const std::shared_ptr<L1Cache> l1 = painter->l1_;
        painter.reset();
        if (l1.use_count() == 1) l1->release();
    }
    painter.reset();
}

bool Painter::is_current(std::uint64_t l1_bytes) const
{
    if (l1_->options().capacity_bytes != l1_bytes) return false;
    const auto found = l1_of_groups().find(share_group_);
    return found != l1_of_groups().end() && found->second.lock() == l1_;
}

FrameReport Painter::draw(const Camera& camera, const Vec3d& local_origin, const RenderOptions& options)
{
    return renderer_->draw(camera, local_origin, options);
}

void Painter::add_view(QWidget* view)
{
    views_.erase(std::remove(views_.begin(), views_.end(), nullptr), views_.end());
    if (std::find(views_.begin(), views_.end(), view) == views_.end()) views_.emplace_back(view);
}

void Painter::wake_views()
{
    for (const QPointer<QWidget>& view : views_)
        if (view) view->update();
}

}  // namespace pcm::host
