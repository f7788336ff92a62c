#include "plugin/edit/edit_plugin.h"

#include "plugin/edit/clip/clip_text.h"
#include "plugin/edit/measure/measure_book.h"
#include "plugin/edit/tools.h"
#include "plugin/host/primitive_book.h"

using namespace pcm::host;

PointCloudTools::PointCloudTools()
{
    keep_clip_boxes_in_projects();
    keep_measures_in_projects();
    keep_primitives_in_projects();
    for (const Tool& tool : tools()) {
        auto* action = new QAction(tool.icon(), tool.name, this);
        action->setCheckable(true);
        // MeshLab shows the tooltip of the action, but not the description.
        action->setToolTip(QString("<b>%1</b><br>%2").arg(tool.name, tool.description));
        actions_ << action;
    }
}

MeshEditInterface* PointCloudTools::getMeshEditInterface(QAction* action)
{
    const int place = actions_.indexOf(action);
    return place < 0 ? nullptr : tools()[static_cast<std::size_t>(place)].make();
}

QString PointCloudTools::getEditToolDescription(QAction* action)
{
    const int place = actions_.indexOf(action);
    return place < 0 ? "" : tools()[static_cast<std::size_t>(place)].description;
}
