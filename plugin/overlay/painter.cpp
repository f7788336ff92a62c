#include "plugin/overlay/painter.h"

#include <QOpenGLContext>

#include <algorithm>
#include <utility>

namespace pcm::host {

namespace {

// Keys are addresses. The entry of a destroyed object has expired, so its address may be reused.
template <class Map>
void drop_expired(Map& map)
{
    for (auto it = map.begin(); it != map.end();) it = it->second.expired() ? map.erase(it) : std::next(it);
}

std::map<const void*, std::weak_ptr<Painter>>& painters()
{
    static std::map<const void*, std::weak_ptr<Painter>> map;
    return map;
}

}  // namespace

std::shared_ptr<Painter> Painter::current(std::uint64_t l1_bytes)
{
    auto& map = painters();
    drop_expired(map);
    auto& slot = map[QOpenGLContext::currentContext()->shareGroup()];
    auto painter = slot.lock();
    if (!painter || painter->renderer_.l1()->options().capacity_bytes != l1_bytes) {
        L1Options options;
        options.capacity_bytes = l1_bytes;
        painter.reset(new Painter(std::make_shared<L1Cache>(options)));
        slot = painter;
    }
    return painter;
}

void Painter::give_back(std::shared_ptr<Painter>& painter)
{
    if (painter && painter.use_count() == 1) {
        painter->renderer_.release();
        painter->renderer_.l1()->release();
    }
    painter.reset();
}

std::shared_ptr<PaintedCloud> PaintedCloud::of(const std::shared_ptr<PointCloud>& cloud, int layer_id,
                                               const std::shared_ptr<Painter>& painter)
{
    drop_expired(painter->clouds_);
    auto& slot = painter->clouds_[{cloud.get(), layer_id}];
    auto painted = slot.lock();
    if (!painted) {
        painted.reset(new PaintedCloud(cloud, painter));
        slot = painted;
    }
    return painted;
}

PaintedCloud::PaintedCloud(const std::shared_ptr<PointCloud>& cloud, const std::shared_ptr<Painter>& painter)
    : painter_(painter), drawn_(std::make_unique<DrawnCloud>(cloud, painter->renderer().l1()))
{
    // Queued to this object's thread, the GUI thread; Qt drops queued calls to a destroyed object.
    drawn_->set_wake([this] { QMetaObject::invokeMethod(this, &PaintedCloud::wake_views, Qt::QueuedConnection); });
}

PaintedCloud::~PaintedCloud()
{
    drawn_.reset();  // first: from here on no loader thread calls this object
}

void PaintedCloud::give_back(std::shared_ptr<PaintedCloud>& cloud)
{
    if (cloud && cloud.use_count() == 1) {
        std::shared_ptr<Painter> painter = cloud->painter_;
        cloud->drawn_->release();
        cloud.reset();
        Painter::give_back(painter);
    }
    cloud.reset();
}

void PaintedCloud::add_view(QWidget* view)
{
    views_.erase(std::remove(views_.begin(), views_.end(), nullptr), views_.end());
    if (std::find(views_.begin(), views_.end(), view) == views_.end()) views_.emplace_back(view);
}

void PaintedCloud::wake_views()
{
    for (const QPointer<QWidget>& view : views_)
        if (view) view->update();
}

}  // namespace pcm::host
