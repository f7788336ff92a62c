#include "plugin/meshlab/render/view.h"

#include "pcm/cloud/vector.h"
#include "pcm/gl/tuning.h"
#include "pcm/io/crs/height_unit.h"
#include "pcm/remote/transfers.h"
#include "plugin/meshlab/native_drawing.h"
#include "plugin/meshlab/render/layer_watch.h"
#include "plugin/meshlab/render/sample_watch.h"
#include "plugin/overlay/aside.h"
#include "plugin/overlay/overlay.h"
#include "plugin/overlay/snapshot_tile.h"
#include "plugin/scene/replaced_trees.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/selected_colour.h"
#include "plugin/scene/text.h"

#include <GL/glew.h>

#include <QElapsedTimer>
#include <QEvent>
#include <QMainWindow>
#include <QMouseEvent>
#include <QPointer>
#include <QThread>
#include <QTimer>
#include <QVariantMap>

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

// A view that is not complete repaints after this time at the latest. Several views of one cloud share its loader, and
// the requests of one view replace those of another.
constexpr int look_again_ms = 250;

constexpr int tile_patience_ms = 30000;  // per tile of a snapshot

// The camera that MeshLab has set up for decorators, without a layer's matrix.
pcm::Camera scene_view()
{
    pcm::Camera view;
    GLint viewport[4];
    glGetDoublev(GL_MODELVIEW_MATRIX, view.modelview.data());
    glGetDoublev(GL_PROJECTION_MATRIX, view.projection.data());
    glGetIntegerv(GL_VIEWPORT, viewport);
    view.width = viewport[2];
    view.height = viewport[3];
    return view;
}

// `before` if `now` is the same camera up to rounding, else `now`. For a snapshot MeshLab computes the projection in
// another way, which rounds differently. It is to show the picture that the user saw.
const pcm::Camera& or_the_same(const pcm::Camera& now, const pcm::Camera& before)
{
    constexpr double rounding = 1e-6;  // a few units of single precision, in which OpenGL keeps its matrices
    if (now.modelview != before.modelview || now.width != before.width || now.height != before.height) return now;
    for (std::size_t i = 0; i < 16; ++i)
        if (!(std::fabs(now.projection[i] - before.projection[i]) <=
              rounding * std::max(1.0, std::fabs(before.projection[i]))))
            return now;
    return before;
}

// The layer's matrix, which MeshLab applies only to its own drawing.
Matrix4d placement_of(const SceneLayer& layer)
{
    Matrix4d placement;
    const LayerMatrix rows = layer.matrix();
    for (std::size_t column = 0; column < 4; ++column)
        for (std::size_t row = 0; row < 4; ++row) placement[column * 4 + row] = static_cast<double>(rows[row][column]);
    return placement;
}

// For picking (scene/picker.h).
ShownClouds shown_clouds(const std::vector<SceneLayer*>& drawn, const CloudStyle& style)
{
    ShownClouds shown;
    for (const SceneLayer* layer : drawn) shown.layers.push_back(layer->id());
    shown.where = style.where;
    const SplatTraits& splats = traits_of(style.splats);
    const float factor =
        splats.shape == SplatShape::sphere ? static_cast<float>(gl_tuning().splats.paraboloid_radius) : 1;
    shown.size_scale = splats.reads_radius ? static_cast<double>(style.radius_scale * factor) : 0;
    shown.fitted = splats.reads_shape;
    return shown;
}

}  // namespace

View* View::find(const SceneView& view)
{
    return view.widget().findChild<View*>(QString(), Qt::FindDirectChildrenOnly);
}

View* View::of(SceneView& view, QAction* decorator)
{
    View* const found = find(view);
    return found ? found : new View(view, decorator);
}

View::View(SceneView& view, QAction* decorator) : QObject(&view.widget()), view_(view), decorator_(decorator)
{
    view.widget().installEventFilter(this);
}

// A widget destroys its context before its children. GL objects that are left are freed with the share group.
View::~View() = default;

void View::begin(const SceneLayer& layer)
{
    layers_.try_emplace(layer.id());
    show_native(layer.id(), false);
}

QString View::draw(const Settings& settings)
{
    if (drawn_) return {};
    drawn_ = true;  // before an exception can be thrown: one attempt per paint event
    draw_scene(settings);
    for (const SceneLayer* shown : view_.scene().layers())
        if (layers_.count(shown->id()) && layers_[shown->id()].report) draw_selected_vertices(view_, *shown);
    draw_over_clouds(settings.map);
    text_ = describe(settings);
    publish_state();
    return text_;
}

// What tools have drawn, and what a map has.
void View::draw_over_clouds(const MapSettings& map)
{
    const auto origin = view_.scene().origin();
    if (!origin) return;
    pcm::Camera scene = tile_ ? scene_view() : shown_;
    scene.origin = *origin;
    const SnapshotTile tile = tile_of(scene, view_.pose().fov);
    const double ratio = view_.pixel_ratio() * tile.magnified;
    std::string unit = "source units";
    for (const auto& [mesh_id, layer] : layers_)
        if (layer.report) unit = plan_unit(layer.painted->cloud().info().metadata);
    map_.draw(scene, tile, distance_to_pivot(view_.pose().fov), unit, map, ratio, shows_information(view_));
    annotations_.draw(view_.scene(), scene, tile, ratio);
}

QString View::describe(const Settings& settings) const
{
    std::vector<OverlayCloud> clouds(report_.clouds.size());
    OverlayDetails details;
    details.target_spacing_px = settings.render.target_spacing_px;
    const L1Statistics l1 = painter_->statistics();
    details.caches.push_back(
        {"video memory", l1.resident_bytes, settings.l1_bytes, l1.hits, l1.compulsory_misses + l1.capacity_misses});
    CacheUse memory{"main memory"};
    for (const auto& [mesh_id, layer] : layers_) {
        const SceneLayer* const shown = layer.report ? view_.scene().layer(mesh_id) : nullptr;
        if (!shown) continue;
        PointCloud& cloud = layer.painted->cloud();
        clouds[*layer.report] = {shown->label(), cloud.info().points, layer.selected, layer.clip.is_on(),
                                 layer.clip.hidden()};
        const L2Statistics l2 = cloud.cache().statistics();
        memory.used_bytes += l2.resident_bytes;
        memory.capacity_bytes += settings.l2_bytes;
        memory.hits += l2.hits;
        memory.misses += l2.compulsory_misses + l2.capacity_misses;
    }
    details.caches.push_back(memory);
    return overlay_text(report_, clouds, settings.details ? &details : nullptr);
}

SceneItem View::item_of(const SceneLayer& layer, const LayerCloud& tree, Layer& entry, const Settings& settings)
{
    SceneItem item;
    item.cloud = &entry.painted->drawn();
    item.origin = tree.origin;
    item.placement = placement_of(layer);
    item.style = settings.style;
    if (auto clip = clip_of(layer)) item.clips.push_back(std::move(*clip));
    item.selected = view_.scene().part<SceneState>().selection(layer);
    entry.selected = item.selected ? item.selected->size() : 0;
    if (const auto colour = chosen_selected_colour())
        item.selected_colour = {static_cast<float>(colour->redF()), static_cast<float>(colour->greenF()),
                                static_cast<float>(colour->blueF())};
    entry.clip.see(*tree.cloud, item.clips);
    return item;
}

void View::draw_scene(const Settings& settings)
{
    report_ = {};
    for (auto& [mesh_id, layer] : layers_) layer.report.reset();
    if (auto painter = Painter::current(settings.l1_bytes); painter != painter_) {
        drop_picture();
        glewInit();  // the GLEW of a file with all plugins is not MeshLab's
        painter_ = std::move(painter);
    }
    const pcm::Camera view = scene_view();
    std::vector<SceneItem> items;
    std::vector<SceneLayer*> drawn;
    for (SceneLayer* layer : view_.scene().layers()) {
        if (!view_.is_shown(*layer) || !is_listed(view_, layer->id(), decorator_)) continue;
        look_at_sample(*layer, view);
        if (!LayerWatch::instance().may_draw(*layer)) continue;
        const auto tree = layer->drawn();
        Layer& entry = layers_[layer->id()];
        if (entry.painted && &entry.painted->cloud() != tree->cloud.get()) drop(entry);
        if (!entry.painted) {
            entry.painted = PaintedCloud::of(tree->cloud, layer->id(), painter_);
            entry.painted->add_view(&view_.widget());
        }
        tree->cloud->cache().set_capacity(settings.l2_bytes);
        items.push_back(item_of(*layer, *tree, entry, settings));
        drawn.push_back(layer);
    }
    const SnapshotTile tile = tile_of(view, view_.pose().fov);
    if (tile.is_part()) {
        report_ = draw_tile(view, items, settings.render);
    } else {
        if (tile_) tile_->release();
        tile_.reset();
        shown_ = or_the_same(view, shown_);
        view_.keep(shown_, shown_clouds(drawn, settings.style));
        report_ = painter_->renderer().draw(picture_, shown_, items, settings.render);
    }
    if (report_.clouds.size() != items.size()) report_.clouds.resize(items.size());
    for (std::size_t i = 0; i < drawn.size(); ++i) layers_[drawn[i]->id()].report = i;
    log_notices(drawn, settings.style);
    look_for_replaced(drawn);
    draw_legends(drawn, settings.colour, tile);
    if (report_.repaint) {
        QTimer::singleShot(0, &view_.widget(), SLOT(update()));
    } else if ((report_.refining || report_.retry_seconds > 0) && !look_again_) {
        look_again_ = true;
        const int wait_ms =
            report_.refining ? look_again_ms : static_cast<int>(std::ceil(1000 * report_.retry_seconds));
        QTimer::singleShot(wait_ms, this, [this] {
            look_again_ = false;
            view_.update();
        });
    }
}

// MeshLab saves the tile after this paint event, so it is first drawn into another framebuffer until its detail is
// loaded. The view's own picture is not changed.
FrameReport View::draw_tile(const pcm::Camera& view, const std::vector<SceneItem>& items, RenderOptions options)
{
    if (!tile_) tile_ = std::make_unique<Picture>();
    options.converge = false;  // refine to the target spacing only, in pixels of the snapshot
    options.paraboloids = true;
    options.frame_budget_ms = options.upload_budget_ms = tile_patience_ms;
    QElapsedTimer taken;
    taken.start();
    FrameReport report;
    {
        const Aside aside(view.width, view.height);
        do {
            report = painter_->renderer().draw(*tile_, view, items, options);
            if (report.refining && !report.repaint) QThread::msleep(2);  // chunks are being loaded
        } while (report.refining && taken.elapsed() < tile_patience_ms);
    }
    if (report.refining && !report.smoothing)
        view_.scene().log(LogLevel::warning,
                          "Point Cloud: a part of the snapshot is less detailed than requested, because loading its "
                          "points took more than "
                          "30 seconds. Take the snapshot again.");
    report = painter_->renderer().draw(*tile_, view, items, options);
    report.refining = report.repaint = false;  // a tile is drawn once
    return report;
}

void View::draw_legends(const std::vector<SceneLayer*>& drawn, const ColourSettings& settings, const SnapshotTile& tile)
{
    legends_.clear();
    for (std::size_t i = 0; i < drawn.size() && settings.legend; ++i) {
        const auto tree = drawn[i]->drawn();
        auto legend = legend_of(report_.clouds[i], height_unit(tree->cloud->info().metadata), settings.hidden_classes);
        if (legend) add_legend(legends_, std::move(*legend), drawn[i]->label());
    }
    legend_box_.draw(legends_, view_.size(), view_.pixel_ratio() * tile.magnified, tile.corner);
    if (problem_ == settings.problem) return;
    problem_ = settings.problem;
    if (!problem_.isEmpty()) view_.scene().log(LogLevel::warning, "Point Cloud: " + problem_);
}

// A click on a class hides its points, or shows them again. Returns whether the event is for the legend.
bool View::click_legend(const QEvent& event)
{
    if (event.type() == QEvent::MouseButtonRelease) return std::exchange(clicked_legend_, false);
    const auto& mouse = static_cast<const QMouseEvent&>(event);
    const auto number = legend_box_.class_at(mouse.pos());
    if (!number || mouse.button() != Qt::LeftButton || legends_.empty()) return false;
    clicked_legend_ = true;
    toggle_class(*view_.settings(), *number);
    view_.update();
    return true;
}

// A drag, double click or right click on the bar of a ramp changes the colour range. Returns whether the event is for
// the legend.
bool View::edit_legend(const QEvent& event)
{
    bool taken = false;
    const auto bars = legends_.empty() ? std::vector<LegendPicture::Bar>() : legend_box_.bars();
    const QPointer<QWidget> alive(&view_.widget());
    const auto change = legend_edit_.take(static_cast<const QMouseEvent&>(event), bars, view_.widget().window(), taken);
    if (!alive || !change) return taken;
    set_range(*view_.settings(), change->range);
    view_.update();
    return taken;
}

void View::log_notices(const std::vector<SceneLayer*>& drawn, const CloudStyle& asked)
{
    for (std::size_t i = 0; i < drawn.size(); ++i) {
        const std::string& notice = report_.clouds[i].notice;
        if (notice.empty() || !layers_[drawn[i]->id()].noticed.emplace(asked.splats, asked.colour, notice).second)
            continue;
        view_.scene().log(LogLevel::system, drawn[i]->label() + ": " + QString::fromStdString(notice));
    }
}

// The error names the file of the tree that could not be read.
void View::look_for_replaced(const std::vector<SceneLayer*>& drawn)
{
    if (report_.error.empty()) return;
    for (const SceneLayer* layer : drawn) {
        const std::shared_ptr<const Tree> tree = layers_[layer->id()].painted->cloud().tree();
        if (report_.error.find(tree->folder().string()) == std::string::npos) continue;
        view_.scene().part<ReplacedTrees>().could_not_load(*tree, report_.error);
    }
}

void View::drop(Layer& layer)
{
    if (!layer.painted) return;
    PaintedCloud::give_back(layer.painted);
    picture_.invalidate();
}

void View::drop_picture()
{
    for (auto& [mesh_id, layer] : layers_) PaintedCloud::give_back(layer.painted);
    picture_.release();
    annotations_.release();
    map_.release();
    if (tile_) tile_->release();
    tile_.reset();
    Painter::give_back(painter_);
}

void View::end(int mesh_id)
{
    const auto found = layers_.find(mesh_id);
    if (found == layers_.end()) return;
    if (found->second.native_hidden) show_native(mesh_id, true);
    drop(found->second);
    layers_.erase(found);
    if (layers_.empty()) drop_picture();
    publish_state();
}

void View::close()
{
    drop_picture();
    layers_.clear();
}

void View::forget(int mesh_id)
{
    const auto found = layers_.find(mesh_id);
    if (found == layers_.end()) return;
    make_current(view_);
    drop(found->second);
    found->second.report.reset();
    if (!view_.scene().layer(mesh_id)) layers_.erase(found);
    if (layers_.empty()) drop_picture();
    publish_state();
}

void View::show_own(int mesh_id)
{
    if (!layers_.count(mesh_id)) return;
    make_current(view_);
    show_native(mesh_id, true);
    view_.update();
}

void View::show_native(int mesh_id, bool show)
{
    if (show_own_points(view_, mesh_id, show)) layers_[mesh_id].native_hidden = !show;
}

// The button in MeshLab's layer panel removes a decorator from a layer without calling endDecorate.
void View::reconcile()
{
    drawn_ = false;
    std::vector<int> ended;
    for (auto& [mesh_id, layer] : layers_) {
        layer.report.reset();
        if (!is_listed(view_, mesh_id, decorator_)) ended.push_back(mesh_id);
    }
    if (!ended.empty()) make_current(view_);
    for (const int mesh_id : ended) end(mesh_id);
    hide_native_after_edit();
}

// When an edit tool ends, MeshLab shows its own points of the layers that it did not know when the tool began, which
// filters and tools have made since, and asks no decorator (mainwindow_RunTime.cpp: endEdit).
void View::hide_native_after_edit()
{
    bool edited = false;
    for (const SceneView* view : view_.scene().views()) edited = edited || view->tool() != nullptr;
    if (std::exchange(edited_, edited) && !edited) {
        make_current(view_);
        for (const auto& [mesh_id, layer] : layers_)
            if (layer.native_hidden) show_native(mesh_id, false);
        if (QMainWindow* const window = view_.window())
            QMetaObject::invokeMethod(window, "updateLayerDialog", Qt::QueuedConnection);
    }
}

// For observers such as tests: whether the picture is final, and what is in it.
void View::publish_state()
{
    bool any = false;
    QString error = QString::fromStdString(report_.error), notice;
    for (const auto& [mesh_id, layer] : layers_) {
        if (!layer.report) continue;
        any = true;
        const CloudReport& cloud = report_.clouds[*layer.report];
        if (!cloud.error.empty()) error = QString::fromStdString(cloud.error);
        if (!cloud.notice.empty()) notice = QString::fromStdString(cloud.notice);
    }
    if (error.isEmpty() && report_.refining) error = QString::fromStdString(network_trouble());
    QVariantMap state;
    state["drawing"] = any;
    qulonglong hidden = 0;
    for (const CloudReport& cloud : report_.clouds) hidden += cloud.points_hidden;
    state["hidden"] = hidden;
    qulonglong selected = 0;
    bool clipped = false;
    for (const auto& [mesh_id, layer] : layers_) {
        if (!layer.report) continue;
        selected += layer.selected;
        clipped = clipped || layer.clip.is_on();
    }
    state["selected"] = selected;
    state["clipped"] = clipped;
    state["points"] = any ? static_cast<qulonglong>(report_.points_drawn) : 0;
    state["complete"] = any && (!report_.refining || report_.smoothing);
    state["smoothing"] = any && report_.smoothing;
    state["frames_averaged"] = any ? report_.frames_averaged : 0;
    state["full_resolution"] = any && report_.full_resolution;
    state["samples"] = report_.samples;
    state["clouds"] = static_cast<int>(report_.clouds.size());
    state["error"] = error;
    state["notice"] = notice;
    state["text"] = text_;
    state["legend"] = any ? lines_of(legends_) : QStringList();
    state["frame"] = ++frame_;
    view_.widget().setProperty("pcm_state", state);
}

bool View::eventFilter(QObject* receiver, QEvent* event)
{
    if (receiver == &view_.widget()) {
        if (event->type() == QEvent::Paint) {
            reconcile();
        } else if (event->type() == QEvent::DeferredDelete) {
            // One of several views is closed; MeshLab does not call decorators then.
            make_current(view_);
            close();
        } else if (event->type() == QEvent::MouseButtonPress || event->type() == QEvent::MouseButtonRelease ||
                   event->type() == QEvent::MouseButtonDblClick) {
            if (edit_legend(*event) || click_legend(*event)) return true;
        } else if (event->type() == QEvent::MouseMove && edit_legend(*event)) {
            return true;
        }
    }
    return QObject::eventFilter(receiver, event);
}

}  // namespace pcm::host
