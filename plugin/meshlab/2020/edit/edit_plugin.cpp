#include "plugin/meshlab/2020/edit/edit_plugin.h"

#include "plugin/meshlab/2020/edit/edit_tool.h"
#include "plugin/meshlab/2020/edit/tool_switch.h"
#include "plugin/meshlab/2020/registry.h"
#include "plugin/scene/clip_text.h"
#include "plugin/scene/measure_book.h"
#include "plugin/scene/primitive_book.h"
#include "plugin/scene/project_unit.h"
#include "plugin/tools/all/tools.h"

using namespace pcm::host;

PointCloudTools::PointCloudTools()
{
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

MeshEditInterface* PointCloudTools::getMeshEditInterface(QAction* action)
{
    const int place = actions_.indexOf(action);
    return place < 0 ? nullptr : new EditTool(tools()[static_cast<std::size_t>(place)].make());
}

QString PointCloudTools::getEditToolDescription(QAction* action)
{
    const int place = actions_.indexOf(action);
    return place < 0 ? "" : tools()[static_cast<std::size_t>(place)].description;
}
