#include "render/view.h"

#include "host/text.h"

#include <meshlab/glarea.h>

#include <GL/glew.h>

#include <QEvent>
#include <QTimer>
#include <QVariantMap>

namespace pcm::host {

namespace {

// A view that is not finished looks again after this time at the latest. Several views of one cloud share its loader,
// and what one asks for replaces what another did.
constexpr int look_again_ms = 250;

// Model-view of the layer, composed in double: MeshLab applies the layer's own matrix for its own drawing only.
Camera camera_of(const MeshModel& layer)
{
    Camera camera{};
    double view[16];
    glGetDoublev(GL_MODELVIEW_MATRIX, view);
    glGetDoublev(GL_PROJECTION_MATRIX, camera.projection);
    glGetIntegerv(GL_VIEWPORT, camera.viewport);
    const auto& transform = layer.cm.Tr;  // row, column
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) {
            double sum = 0;
            for (int k = 0; k < 4; ++k) sum += view[k * 4 + row] * static_cast<double>(transform[k][column]);
            camera.modelview[column * 4 + row] = sum;
        }
    return camera;
}

std::string megabytes(std::uint64_t bytes) { return grouped((bytes + (1u << 19)) >> 20); }

// How much of a cache is in use, and how often it had what was asked for.
std::string cache_text(const std::string& name, std::uint64_t used, std::uint64_t capacity, std::uint64_t hits, std::uint64_t misses)
{
    const std::uint64_t asked = hits + misses;
    return name + " " + megabytes(used) + " of " + megabytes(capacity) + " MB, " + (asked ? grouped(100 * hits / asked) : "0") + " % hits";
}

QString status_text(const FrameReport& report, std::uint64_t total, double target_px, const std::string& caches)
{
    const std::string detail = report.screen_error_px > 0 ? "screen error " + brief(report.screen_error_px) +
                                                                " px (target " + brief(target_px) + ")"
                                                          : std::string("all that is in view");
    const std::string points = grouped(report.points_drawn) + " of " + grouped(total) + " points, " + detail;
    const std::string time = brief(report.measured_ms > 0 ? report.measured_ms : report.frame_ms) + " ms a frame, " +
                             (report.refining ? "refining" : "complete");
    QString rows;
    for (const std::string& row : {points, time, caches, report.error})
        if (!row.empty()) rows += "<tr><td>" + QString::fromStdString(row).toHtmlEscaped() + "</td></tr>";
    return "<table>" + rows + "</table>";
}

}  // namespace

View* View::find(GLArea* area) { return area->findChild<View*>(QString(), Qt::FindDirectChildrenOnly); }

View* View::of(GLArea* area, QAction* decorator)
{
    View* view = find(area);
    return view ? view : new View(area, decorator);
}

View::View(GLArea* area, QAction* decorator) : QObject(area), area_(area), decorator_(decorator)
{
    area->installEventFilter(this);
}

// The context has gone before its widget's children: what is left on the card goes with the share group.
View::~View() = default;

void View::begin(MeshModel& layer)
{
    layers_.try_emplace(layer.id());
    show_native(layer.id(), false);
}

QString View::draw(const MeshModel& layer, const TreeLayer& tree, const Settings& settings)
{
    Layer& entry = layers_[layer.id()];
    if (entry.painter && (&entry.painter->cloud() != tree.cloud.get() || !entry.painter->is_current(settings.l1_bytes)))
        Painter::give_back(entry.painter);
    if (!entry.painter) {
        entry.painter = Painter::of(tree.cloud, settings.l1_bytes);
        entry.painter->add_view(area_);
    }
    tree.cloud->cache().set_capacity(settings.l2_bytes);
    RenderOptions options = settings.render;
    if (options.colour == ColourMode::rgb && !tree.has_rgb) options.colour = ColourMode::intensity;
    entry.report = entry.painter->draw(camera_of(layer), tree.origin, options);
    entry.drawn = true;
    if (entry.report.repaint) {
        QTimer::singleShot(0, area_, SLOT(update()));
    } else if (entry.report.refining && !look_again_) {
        look_again_ = true;
        QTimer::singleShot(look_again_ms, this, [this] {
            look_again_ = false;
            area_->update();
        });
    }
    publish_state();
    const L1Statistics l1 = entry.painter->statistics();
    const L2Statistics l2 = tree.cloud->cache().statistics();
    const std::string caches =
        cache_text("video memory", l1.resident_bytes, settings.l1_bytes, l1.hits, l1.compulsory_misses + l1.capacity_misses) + "; " +
        cache_text("RAM", l2.resident_bytes, settings.l2_bytes, l2.hits, l2.compulsory_misses + l2.capacity_misses);
    return status_text(entry.report, tree.cloud->info().points, options.target_spacing_px, caches);
}

void View::end(int mesh_id)
{
    const auto found = layers_.find(mesh_id);
    if (found == layers_.end()) return;
    if (found->second.native_hidden) show_native(mesh_id, true);
    Painter::give_back(found->second.painter);
    layers_.erase(found);
    publish_state();
}

void View::close()
{
    for (auto& [mesh_id, layer] : layers_) Painter::give_back(layer.painter);
    layers_.clear();
}

void View::forget(int mesh_id)
{
    const auto found = layers_.find(mesh_id);
    if (found == layers_.end()) return;
    area_->makeCurrent();
    Painter::give_back(found->second.painter);
    if (!area_->md() || !area_->md()->getMesh(mesh_id)) layers_.erase(found);
    publish_state();
}

void View::show_native(int mesh_id, bool show)
{
    MLSceneGLSharedDataContext* shared = area_->mvc() ? area_->mvc()->sharedDataContext() : nullptr;
    if (!shared || !area_->md()->getMesh(mesh_id)) return;
    MLRenderingData data;
    shared->getRenderInfoPerMeshView(mesh_id, area_->context(), data);
    const auto points = MLRenderingData::PR_POINTS;
    layers_[mesh_id].native_hidden = !show;
    if (data.isPrimitiveActive(points) == show) return;
    if (show) {
        MLRenderingData::RendAtts attributes;
        attributes[MLRenderingData::ATT_NAMES::ATT_VERTPOSITION] = true;
        attributes[MLRenderingData::ATT_NAMES::ATT_VERTCOLOR] = true;
        data.set(points, attributes);
    } else {
        data.set(points, false);
    }
    shared->setRenderingDataPerMeshView(mesh_id, area_->context(), data);
    shared->manageBuffers(mesh_id);
}

// The button in MeshLab's layer panel takes a decorator off a layer without telling it.
void View::reconcile()
{
    std::vector<int> ended;
    for (auto& [mesh_id, layer] : layers_) {
        layer.drawn = false;
        if (!area_->iPerMeshDecoratorsListMap.value(mesh_id).contains(decorator_)) ended.push_back(mesh_id);
    }
    if (!ended.empty()) area_->makeCurrent();
    for (const int mesh_id : ended) end(mesh_id);
}

// For whoever watches from outside, such as a test: is the picture final, and how much is in it.
void View::publish_state()
{
    std::uint64_t points = 0;
    bool complete = true, any = false;
    QString error;
    for (const auto& [mesh_id, layer] : layers_) {
        if (!layer.drawn) continue;
        any = true;
        points += layer.report.points_drawn;
        complete = complete && !layer.report.refining;
        if (!layer.report.error.empty()) error = QString::fromStdString(layer.report.error);
    }
    QVariantMap state;
    state["drawing"] = any;
    state["points"] = static_cast<qulonglong>(points);
    state["complete"] = complete && any;
    state["error"] = error;
    state["frame"] = ++frame_;
    area_->setProperty("pcm_state", state);
}

bool View::eventFilter(QObject* receiver, QEvent* event)
{
    if (receiver == area_) {
        if (event->type() == QEvent::Paint) {
            reconcile();
        } else if (event->type() == QEvent::DeferredDelete) {
            // One of several views is closed; nobody tells decorators.
            area_->makeCurrent();
            close();
        }
    }
    return QObject::eventFilter(receiver, event);
}

}  // namespace pcm::host
