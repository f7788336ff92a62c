#include "plugin/render/render_plugin.h"

#include "plugin/host/registry.h"
#include "plugin/host/text.h"
#include "plugin/render/dock.h"
#include "plugin/render/opening.h"
#include "plugin/render/project_settings.h"
#include "plugin/render/view.h"

#include <meshlab/glarea.h>

#include <QPointer>
#include <QTimer>

using namespace pcm::host;

PointCloudDecorator::PointCloudDecorator()
{
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
            if (View* view = View::find(area)) view->forget(mesh_id);
    });
}

QString PointCloudDecorator::decorationInfo(FilterIDType) const
{
    return "Draws a point cloud tree at the detail that the view needs and loads its points in the background.";
}

bool PointCloudDecorator::isDecorationApplicable(QAction*, const MeshModel& layer, QString& reason) const
{
    if (Registry::instance().find(layer)) return true;
    reason =
        "the layer '" + layer.label() +
        "' shows no point cloud tree. Open the index.pct of a tree, or a cloud with more points than Tools > Options "
        "allows in a layer, or build a tree with the filter Build Point Cloud Tree";
    return false;
}

void PointCloudDecorator::initGlobalParameterSet(QAction*, RichParameterList& parameters) { add_settings(parameters); }

bool PointCloudDecorator::startDecorate(QAction* action, MeshModel& layer, const RichParameterList*, GLArea* area)
{
    if (!Registry::instance().find(layer)) return false;
    View::of(area, action)->begin(layer);
    return true;
}

void PointCloudDecorator::decorateMesh(QAction* action, MeshModel& layer, const RichParameterList* parameters,
                                       GLArea* area, QPainter*, GLLogStream& document_log)
{
    if (!Registry::instance().find(layer)) return;
    QString text;
    try {
        text = View::of(area, action)->draw(read_settings(*parameters));
    } catch (...) {  // MeshLab's painting does not catch exceptions
        text = QString::fromStdString(current_error()).toHtmlEscaped();
    }
    // A view that was split off shows MeshLab's own points at first. It is to show the same as this one.
    for (GLArea* other : area->mvc()->viewerList) {
        if (!other || View::find(other)) continue;
        QPointer<QWidget> alive(other);
        // The log belongs to the document: if the document is destroyed, Qt drops this call.
        QTimer::singleShot(0, &layer.parent->Log, [this, alive, other, document = layer.parent, mesh_id = layer.id()] {
            MeshModel* shown = alive ? document->getMesh(mesh_id) : nullptr;
            if (!shown) return;
            show_at_first_paint(*other, mesh_id);
            switch_on(*other, *shown);
        });
    }
    // MeshLab clears these lines only when it shows them.
    if (area->infoAreaVisible && !text.isEmpty()) document_log.RealTimeLog("Point Cloud", QString(), text);
}

void PointCloudDecorator::endDecorate(QAction* action, MeshModel& layer, const RichParameterList*, GLArea* area)
{
    // MeshLab ends and starts every decorator after each filter and import. When a user switches ours off, it is
    // removed from the list first.
    if (area->iPerMeshDecoratorsListMap.value(layer.id()).contains(action)) return;
    if (View* view = View::find(area)) view->end(layer.id());
}

void PointCloudDecorator::endDecorate(QAction*, MeshDocument&, const RichParameterList*, GLArea* area)
{
    if (View* view = View::find(area)) view->close();
}

void PointCloudDecorator::show_at_first_paint(GLArea& area, int mesh_id)
{
    ProjectSettings::follow(area);
    Opening::expect(area, mesh_id, [this](GLArea& view, MeshModel& layer) { list(view, layer); });
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
    Dock::show_for(area);
    area.update();
    QMetaObject::invokeMethod(&area, "updateMainWindowMenus");
    // Makes the layer panel list our parameters.
    for (QWidget* window : QApplication::topLevelWidgets())
        if (window->inherits("MainWindow")) QMetaObject::invokeMethod(window, "updateLayerDialog");
}
