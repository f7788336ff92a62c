// Shows the table of tools (tools.h) to MeshLab.
#pragma once

#include "plugin/meshlab/2020/meshlab.h"

class PointCloudTools : public QObject, public MeshEditInterfaceFactory {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(MESH_EDIT_INTERFACE_FACTORY_IID)
    Q_INTERFACES(MeshEditInterfaceFactory)

public:
    PointCloudTools();
    QList<QAction*> actions() const override { return actions_; }
    MeshEditInterface* getMeshEditInterface(QAction* action) override;  // one per view
    QString getEditToolDescription(QAction* action) override;

private:
    QList<QAction*> actions_;
};
