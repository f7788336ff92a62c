#include "plugin/edit/edit_plugin.h"

#include "plugin/edit/icon.h"
#include "plugin/edit/walk/first_person_tool.h"

using namespace pcm::host;

PointCloudTools::PointCloudTools()
{
    first_person_ = new QAction(first_person_icon(), "First Person Navigation", this);
    first_person_->setCheckable(true);
    // MeshLab shows the tooltip of the action, but not the description.
    first_person_->setToolTip(
        QString("<b>%1</b><br>%2").arg(first_person_->text(), getEditToolDescription(first_person_)));
    actions_ << first_person_;
}

MeshEditInterface* PointCloudTools::getMeshEditInterface(QAction* action)
{
    return action == first_person_ ? new FirstPersonTool : nullptr;
}

QString PointCloudTools::getEditToolDescription(QAction*)
{
    return "Walk through the scene: W A S D and E Q move, Shift moves faster, dragging looks around, the wheel changes "
           "the "
           "speed. The speed is proportional to the distance of the nearest points.";
}
