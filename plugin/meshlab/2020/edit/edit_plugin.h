// Shows the table of tools (tools/all/tools.h) to MeshLab.
#pragma once

#include "plugin/meshlab/2020/meshlab.h"
#include "plugin/tools/tool.h"

#include <memory>

namespace pcm::host {

// A tool as MeshLab's interface of edit tools: it passes on what happens in the view that the tool works in.
// One for each tool and view; deleted with the view. GUI thread.
class EditTool : public QObject, public MeshEditInterface {
    Q_OBJECT
    Q_INTERFACES(MeshEditInterface)

public:
    explicit EditTool(std::unique_ptr<Tool> tool) : tool_(std::move(tool)) {}
    QString pluginName() const override { return "EditPointCloud"; }

    // Tools work on all layers; the current layer does not matter.
    bool isSingleMeshEdit() const override { return false; }
    bool StartEdit(MeshDocument& document, GLArea* area, MLSceneGLSharedDataContext* shared) override;
    void EndEdit(MeshDocument& document, GLArea* area, MLSceneGLSharedDataContext* shared) override;
    void LayerChanged(MeshDocument&, MeshModel&, GLArea*, MLSceneGLSharedDataContext*) override {}
    void Decorate(MeshModel& layer, GLArea* area, QPainter* painter) override;

    void mousePressEvent(QMouseEvent* event, MeshModel&, GLArea* area) override;
    void mouseMoveEvent(QMouseEvent* event, MeshModel&, GLArea* area) override;
    void mouseReleaseEvent(QMouseEvent* event, MeshModel&, GLArea* area) override;
    void wheelEvent(QWheelEvent* event, MeshModel&, GLArea* area) override;
    void keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* area) override;
    void keyReleaseEvent(QKeyEvent* event, MeshModel&, GLArea* area) override;

private:
    const std::unique_ptr<Tool> tool_;
    GLArea* area_ = nullptr;  // while the tool is on
};

}  // namespace pcm::host

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
