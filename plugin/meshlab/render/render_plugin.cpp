#include "plugin/meshlab/render/render_plugin.h"

#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/drawn_copy.h"
#include "plugin/meshlab/meshlab.h"
#include "plugin/meshlab/registry.h"
#include "plugin/meshlab/render/layer_watch.h"
#include "plugin/meshlab/render/opening.h"
#include "plugin/meshlab/render/sample_watch.h"
#include "plugin/meshlab/render/view.h"
#include "plugin/meshlab/rich_parameters.h"
#include "plugin/panels/clouds/clouds_dock.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/bookmarks.h"
#include "plugin/scene/import_settings.h"
#include "plugin/scene/layer_marks.h"
#include "plugin/scene/project_camera.h"
#include "plugin/scene/text.h"
#include "plugin/scene/tree_cache.h"
#include "plugin/settings/project_settings.h"
#include "plugin/settings/settings.h"
#include "plugin/settings/settings_dock.h"
#include "plugin/settings/stored_defaults.h"

#include <QPointer>
#include <QTimer>

using namespace pcm::host;

PointCloudDecorator::PointCloudDecorator()
{
    refuse_second(PointCloudDecorator::pluginName());
    typeList << 0;
    auto* action = new QAction(decorationName(0), this);
    action->setCheckable(true);
    actionList << action;

    Registry& registry = Registry::instance();
    connect(&registry, &Registry::attached, this, [this](MeshDocument* document, int mesh_id) {
        for (GLArea* area : views_of(*document)) show_at_first_paint(*area, mesh_id);
    });
    connect(&registry, &Registry::attached, this, &PointCloudDecorator::show_when_idle);
    connect(&registry, &Registry::detached, this, [](MeshDocument* document, int mesh_id) {
        for (GLArea* area : views_of(*document))
            if (View* view = View::find(view_of(*area))) view->forget(mesh_id);
    });
    connect(&registry, &Registry::copy_dropped, this, [](MeshDocument* document, int mesh_id) {
        for (GLArea* area : views_of(*document))
            if (View* view = View::find(view_of(*area))) view->show_own(mesh_id);
    });
    connect(&LayerWatch::instance(), &LayerWatch::copy_wanted, this,
            [this](Scene* scene, int mesh_id) { copy_again(document_of(*scene), mesh_id); });
    TreeCache::instance().remove_leftovers();
    keep_bookmarks_in_projects();
    keep_layer_marks_in_projects();
    keep_camera_in_projects();
}

QString PointCloudDecorator::decorationInfo(int) const
{
    return "Draws a point cloud tree at the detail that the view needs and loads its points in the background. An "
           "ordinary layer of points is drawn in the same way, through a temporary tree of its vertices.";
}

bool PointCloudDecorator::isDecorationApplicable(PluginAction*, const MeshModel& layer, QString& reason) const
{
    if (Registry::instance().drawn(layer)) return true;
    reason = QString::fromStdString(why_not_drawn(layer));
    return reason.isEmpty();
}

void PointCloudDecorator::initGlobalParameterList(PluginAction*, RichParameterList& parameters)
{
    Parameters defaults;
    if (!importers_have_settings) add_global_settings(defaults);
    add_settings(defaults);
    follow_new_defaults(defaults, *setting_store(nullptr));
    add_to(parameters, defaults);
}

bool PointCloudDecorator::startDecorate(PluginAction*, MeshModel& layer, const RichParameterList*, GLArea* area)
{
    const bool is_listed = area->iPerMeshDecoratorsListMap.value(layer.id()).contains(actionList.front());
    LayerWatch::instance().check(layer_of(layer));
    // A layer that has just changed is copied again when it rests.
    if (!Registry::instance().drawn(layer) && (is_listed || !copy_layer(layer))) return is_listed;
    View::of(view_of(*area), actionList.front())->begin(layer_of(layer));
    return true;
}

void PointCloudDecorator::decorateMesh(PluginAction*, MeshModel& layer, const RichParameterList* parameters,
                                       GLArea* area, QPainter* painter, GLLogStream& document_log)
{
    if (!Registry::instance().drawn(layer)) return;
    QString text;
    try {
        text = View::of(view_of(*area), actionList.front())
                   ->draw(read_settings(parameters_of(*parameters, setting_prefix)));
    } catch (...) {  // MeshLab's painting does not catch exceptions
        text = QString::fromStdString(current_error()).toHtmlEscaped();
    }
    if (painter && !View::of(view_of(*area), actionList.front())->draws_tile() && is_first_listed(*area, layer))
        draw_sample_notices(view_of(*area), *painter);
    // A view that was split off shows MeshLab's own points at first. It is to show the same as this one.
    for (GLArea* other : area->mvc()->viewerList) {
        if (!other || View::find(view_of(*other))) continue;
        QPointer<QWidget> alive(other);
        // The log belongs to the document: if the document is destroyed, Qt drops this call.
        MeshDocument* const document = &document_of(layer);
        QTimer::singleShot(0, &document->Log, [this, alive, other, document, mesh_id = layer.id()] {
            MeshModel* shown = alive ? document->getMesh(mesh_id) : nullptr;
            if (!shown) return;
            show_at_first_paint(*other, mesh_id);
            switch_on(*other, *shown);
        });
    }
    // MeshLab clears these lines only when it shows them.
    if (area->infoAreaVisible && !text.isEmpty()) show_line(document_log, "Point Cloud", text);
}

void PointCloudDecorator::endDecorate(PluginAction*, MeshModel& layer, const RichParameterList*, GLArea* area)
{
    // MeshLab ends and starts every decorator after each filter and import. When a user switches ours off, it is
    // removed from the list first.
    if (area->iPerMeshDecoratorsListMap.value(layer.id()).contains(actionList.front())) return;
    if (View* view = View::find(view_of(*area))) view->end(layer.id());
}

void PointCloudDecorator::endDecorate(PluginAction*, MeshDocument&, const RichParameterList*, GLArea* area)
{
    if (View* view = View::find(view_of(*area))) view->close();
}

void PointCloudDecorator::show_at_first_paint(GLArea& area, int mesh_id)
{
    if (area.md()) ProjectSettings::follow(view_of(area));
    Opening::expect(area, mesh_id, [this](GLArea& view, MeshModel& layer) { list(view, layer); });
}

bool PointCloudDecorator::is_on(const MeshModel& layer)
{
    for (GLArea* area : views_of(document_of(layer)))
        if (area->iPerMeshDecoratorsListMap.value(layer.id()).contains(actionList.front())) return true;
    return false;
}

bool PointCloudDecorator::copy_layer(MeshModel& layer)
{
    try {
        Operation operation(nullptr);
        draw_as_cloud(layer, operation.progress());
        return true;
    } catch (...) {
        write_log(document_of(layer).Log, GLLogStream::WARNING,
                  "The layer '" + layer.label() + "' is drawn by MeshLab: " + QString::fromStdString(current_error()));
        return false;
    }
}

void PointCloudDecorator::copy_again(MeshDocument& document, int mesh_id)
{
    MeshModel* const layer = document.getMesh(mesh_id);
    if (!layer || !is_on(*layer) || !why_not_drawn(*layer).empty()) return;
    if (static_cast<std::size_t>(layer->cm.vn) <= most_copied_unasked) {
        copy_layer(*layer);
        return;
    }
    write_log(document.Log, GLLogStream::WARNING,
              "The layer '" + layer->label() +
                  "' has changed and is drawn by MeshLab. Switch Render > Show Point Cloud off and on to draw it as a "
                  "point cloud again.");
}

// Whether the layer is the first of those that MeshLab draws in a paint event.
bool PointCloudDecorator::is_first_listed(GLArea& area, const MeshModel& layer)
{
    for (const MeshModel* other : models_of(*area.md()))
        if (area.meshVisibilityMap.value(other->id()) && Registry::instance().drawn(*other) &&
            area.iPerMeshDecoratorsListMap.value(other->id()).contains(actionList.front()))
            return other->id() == layer.id();
    return false;
}

void PointCloudDecorator::show_when_idle(MeshDocument* document, int mesh_id)
{
    constexpr int wait_ms = 20;
    QPointer<MeshDocument> alive(document);
    QTimer::singleShot(document->isBusy() ? wait_ms : 0, this, [this, alive, mesh_id] {
        if (!alive) return;
        if (alive->isBusy()) return show_when_idle(alive, mesh_id);
        if (MeshModel* layer = alive->getMesh(mesh_id))
            for (GLArea* area : views_of(*alive)) switch_on(*area, *layer);
    });
}

// Like GLArea::setDecorator, but for this layer: the current layer may have changed in the meantime.
void PointCloudDecorator::list(GLArea& area, MeshModel& layer)
{
    QAction* const action = actionList.front();
    QList<QAction*>& decorators = area.iPerMeshDecoratorsListMap[layer.id()];
    area.makeCurrent();
    if (startDecorate(action, layer, area.glas.currentGlobalParamSet, &area) && !decorators.contains(action))
        decorators.push_back(action);
}

void PointCloudDecorator::switch_on(GLArea& area, MeshModel& layer)
{
    list(area, layer);
    Dock::show_for(view_of(area));
    if (QMainWindow* const window = window_of(area))
        CloudsDock::show_for(view_of(area), [window] { return current_view(*window); });
    area.update();
    QMetaObject::invokeMethod(&area, "updateMainWindowMenus");
    // Makes the layer panel list our parameters.
    for (QWidget* window : QApplication::topLevelWidgets())
        if (window->inherits("MainWindow")) QMetaObject::invokeMethod(window, "updateLayerDialog");
}
