#include "plugin/meshlab/edit/edit_plugin.h"

#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/edit/tool_switch.h"
#include "plugin/meshlab/registry.h"
#include "plugin/scene/clip_text.h"
#include "plugin/scene/measure_book.h"
#include "plugin/scene/primitive_book.h"
#include "plugin/scene/project_unit.h"
#include "plugin/tools/all/tools.h"

#include <QTimer>

namespace pcm::host {

namespace {

// MeshLab marks the current layer as modified when it has started a tool, and ours change none by that.
void keep_unmodified(MeshDocument& document)
{
    if (const MeshModel* layer = document.mm())
        QTimer::singleShot(0, &document, [document = &document, id = layer->id(), changed = layer->meshModified()] {
            if (MeshModel* shown = document->getMesh(id)) shown->setMeshModified(changed);
        });
}

}  // namespace

bool EditTool::startEdit(MeshDocument& document, GLArea* area, MLSceneGLSharedDataContext*)
{
    setParent(area);  // the view does not delete its tools otherwise
    if (!tool_->start(view_of(*area))) return false;
    area_ = area;
    keep_unmodified(document);
    return true;
}

void EditTool::endEdit(MeshDocument&, GLArea* area, MLSceneGLSharedDataContext*)
{
    if (area != area_) return;
    tool_->end();
    area_ = nullptr;
}

void EditTool::decorate(MeshModel&, GLArea* area, QPainter* painter)
{
    if (area == area_) tool_->draw(painter);
}

void EditTool::mousePressEvent(QMouseEvent* event, MeshModel&, GLArea* area)
{
    if (area == area_) tool_->mousePressEvent(event);
}

void EditTool::mouseMoveEvent(QMouseEvent* event, MeshModel&, GLArea* area)
{
    if (area == area_) tool_->mouseMoveEvent(event);
}

void EditTool::mouseReleaseEvent(QMouseEvent* event, MeshModel&, GLArea* area)
{
    if (area == area_) tool_->mouseReleaseEvent(event);
}

void EditTool::wheelEvent(QWheelEvent* event, MeshModel&, GLArea* area)
{
    if (area == area_) tool_->wheelEvent(event);
}

void EditTool::keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* area)
{
    if (area == area_) tool_->keyPressEvent(event);
}

void EditTool::keyReleaseEvent(QKeyEvent* event, MeshModel&, GLArea* area)
{
    if (area == area_) tool_->keyReleaseEvent(event);
}

}  // namespace pcm::host

using namespace pcm::host;

PointCloudTools::PointCloudTools()
{
    refuse_second(PointCloudTools::pluginName());
    keep_clip_boxes_in_projects();
    keep_measures_in_projects();
    keep_primitives_in_projects();
    keep_units_in_projects();
    for (const ToolRow& tool : tools()) {
        auto* action = new QAction(tool.icon(), tool.name, this);
        action->setCheckable(true);
        // MeshLab shows the tooltip of the action, but not the description.
        action->setToolTip(QString("<b>%1</b><br>%2").arg(tool.name, tool.description));
        make_switchable(*action);
        actions_ << action;
    }
    // With the first cloud: a window without any has no use for them.
    connect(&Registry::instance(), &Registry::attached, this, [this] { show_tool_bar(actions_); });
}

const ToolRow* PointCloudTools::row_of(PluginAction* action) const
{
    const int place = actions_.indexOf(const_cast<QAction*>(action));
    return place < 0 ? nullptr : &tools()[static_cast<std::size_t>(place)];
}

pcm::host::EditTool* PointCloudTools::getEditTool(PluginAction* action)
{
    const ToolRow* const row = row_of(action);
    return row ? new pcm::host::EditTool(row->make()) : nullptr;
}

QString PointCloudTools::getEditToolDescription(PluginAction* action)
{
    const ToolRow* const row = row_of(action);
    return row ? row->description : "";
}
