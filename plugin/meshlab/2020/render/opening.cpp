#include "plugin/meshlab/2020/render/opening.h"

#include "pcm/view/first_view.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/meshlab.h"
#include "plugin/meshlab/2020/registry.h"
#include "plugin/meshlab/2020/trackball_pose.h"
#include "plugin/settings/settings.h"

#include <QCoreApplication>
#include <QFont>
#include <QFontMetrics>
#include <QMouseEvent>
#include <QTimer>

#include <cmath>
#include <utility>
#include <vector>

namespace pcm::host {

namespace {

using Track = Opening::Track;

Track track_of(const vcg::Similarityf& s)
{
    return {s.rot[0], s.rot[1], s.rot[2], s.rot[3], s.tra[0], s.tra[1], s.tra[2], s.sca};
}

vcg::Similarityf identity()
{
    vcg::Similarityf track;
    track.SetIdentity();
    return track;
}

// As the trackball is before MeshLab has reset it for the first layer.
bool is_initial(const Track& track) { return track == track_of(identity()); }

// As GLArea::resetTrackBall() leaves it.
bool is_reset(GLArea& area)
{
    const vcg::Similarityf& track = area.trackball.track;
    const Box3m box = area.md()->bbox();
    vcg::Similarityf reset = identity();
    reset.sca = 3.0f / box.Diag();
    reset.tra.Import(-box.Center());
    for (int i = 0; i < 4; ++i)
        if (track.rot[i] != reset.rot[i]) return false;
    const float rounding = 1e-5f;
    return std::fabs(track.sca - reset.sca) <= rounding * reset.sca &&
           (track.tra - reset.tra).Norm() <= rounding * box.Diag();
}

// The pixels at the bottom of the view that MeshLab's information about the layer covers (glarea.cpp: displayInfo). Not
// in a view that would have little left.
int covered_by_info(const GLArea& area)
{
    if (!area.infoAreaVisible) return 0;
    QFont font("Helvetica");
    font.setPixelSize(12);
    const QFontMetrics metrics(font);
    const int height = 6 * (metrics.height() + metrics.leading()) + 4;
    return height < area.height() / 3 ? height : 0;
}

// What a view shows, in the document's coordinates.
struct Shown {
    std::vector<Vec3d> points;    // sampled points
    std::vector<ScanPose> poses;  // scanner poses of the only scan
};

// The layer's vertices in the document's coordinates, the layer's matrix included.
std::vector<Vec3d> placed_vertices(const MeshModel& layer)
{
    std::vector<Vec3d> points;
    for (const CVertexO& vertex : layer.cm.vert) {
        if (vertex.IsD()) continue;
        const Point3m p = layer.cm.Tr * vertex.cP();
        points.push_back({static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
    }
    return points;
}

// Nothing if the view shows anything but trees.
std::optional<Shown> shown_trees(GLArea& area)
{
    Shown shown;
    std::size_t layers = 0;
    for (const MeshModel* layer : area.md()->meshList) {
        if (!layer || !area.meshVisibilityMap.value(layer->id())) continue;
        const auto tree = Registry::instance().drawn(*layer);
        if (!tree) return std::nullopt;
        const std::vector<Vec3d> more = placed_vertices(*layer);
        shown.points.insert(shown.points.end(), more.begin(), more.end());
        shown.poses.clear();
        if (++layers > 1 || layer->cm.Tr != Matrix44m::Identity()) continue;
        shown.poses = scan_poses(tree->cloud->info().metadata);
        for (ScanPose& pose : shown.poses)
            for (std::size_t a = 0; a < 3; ++a) pose.eye[a] -= tree->origin[a];
    }
    return shown;
}

}  // namespace

void Opening::expect(GLArea& area, int mesh_id, const Show& show)
{
    auto* opening = area.findChild<Opening*>(QString(), Qt::FindDirectChildrenOnly);
    if (!opening) opening = new Opening(&area);
    opening->show_ = show;
    opening->waiting_.insert(mesh_id);
    if (opening->known_.insert(mesh_id).second) opening->to_look_ = true;
}

Opening::Opening(GLArea* area) : QObject(area), area_(area)
{
    area->installEventFilter(this);
    connect(area, SIGNAL(transmitPickedPos(QString, Point2m)), SLOT(place_sent(QString)));
}

bool Opening::eventFilter(QObject* receiver, QEvent* event)
{
    if (receiver == area_ && event->type() == QEvent::Paint) before_paint();
    if (receiver == area_ && event->type() == QEvent::MouseButtonDblClick)
        double_click_ = static_cast<QMouseEvent*>(event)->pos();
    return QObject::eventFilter(receiver, event);
}

// MeshLab does not initialize GLArea::hasToGetPickCoords. Where it happens to be set, the first double click of a view
// is sent to a parameter that nothing has asked for, and the view is not centred on the point.
void Opening::place_sent(const QString& name)
{
    if (!name.isEmpty()) return;
    QTimer::singleShot(0, this, [this] {
        QMouseEvent again(QEvent::MouseButtonDblClick, double_click_, area_->mapToGlobal(double_click_), Qt::LeftButton,
                          Qt::LeftButton, Qt::NoModifier);
        QCoreApplication::sendEvent(area_, &again);
    });
}

void Opening::before_paint()
{
    set_background();
    MeshDocument* document = area_->md();
    if (!document || document->isBusy()) return;  // MeshLab draws no layer
    for (const int mesh_id : std::exchange(waiting_, {}))
        if (MeshModel* layer = document->getMesh(mesh_id)) show_(*area_, *layer);
    look();
}

void Opening::set_background()
{
    GLAreaSetting& view = area_->glas;
    const auto colour = read_settings(view_of(*area_).settings()->all()).background;
    if (colour) {
        const vcg::Color4b bytes(static_cast<unsigned char>(colour->red()), static_cast<unsigned char>(colour->green()),
                                 static_cast<unsigned char>(colour->blue()), 255);
        view.backgroundTopColor = view.backgroundBotColor = bytes;
    } else if (own_background_) {
        view.backgroundTopColor = view.currentGlobalParamSet->getColor4b(GLAreaSetting::backgroundTopColorParam());
        view.backgroundBotColor = view.currentGlobalParamSet->getColor4b(GLAreaSetting::backgroundBotColorParam());
    }
    own_background_ = colour.has_value();
}

void Opening::look()
{
    const Track track = track_of(area_->trackball.track);
    if (looked_ && track != *looked_) looked_.reset();
    const bool resized = looked_ && looked_size_ != area_->size();
    if (!resized && (!to_look_ || is_initial(track))) return;
    const bool may_move = resized || is_reset(*area_);
    to_look_ = false;
    if (!may_move || area_->isRaster() || !read_settings(view_of(*area_).settings()->all()).oblique_first_view) return;
    const auto shown = shown_trees(*area_);
    if (!shown || is_orthographic(area_->fov)) return;
    const double fov = static_cast<double>(area_->fov);
    if (const auto pose =
            first_view(shown->points, shown->poses, {fov, area_->width(), area_->height(), covered_by_info(*area_)})) {
        area_->trackball.track = trackball_of(*pose, area_->fov);
        looked_ = track_of(area_->trackball.track);
        looked_size_ = area_->size();
    }
}

}  // namespace pcm::host
