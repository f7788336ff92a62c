// Shows the table of tools (tools/all/tools.h) to MeshLab.
#pragma once

#include "plugin/meshlab/plugin_bases.h"
#include "plugin/tools/all/tools.h"
#include "plugin/tools/tool.h"

#include <memory>

namespace pcm::host {

// A tool as MeshLab's interface of edit tools: it passes on what happens in the view that the tool works in.
// One for each tool and view; deleted with the view. GUI thread.
class EditTool : public QObject, public EditToolBase {
    Q_OBJECT

public:
    explicit EditTool(std::unique_ptr<Tool> tool) : tool_(std::move(tool)) {}

    // Tools work on all layers; the current layer does not matter.
    bool isSingleMeshEdit() const override { return false; }
    bool startEdit(MeshDocument& document, GLArea* area, MLSceneGLSharedDataContext* shared) override;
    void endEdit(MeshDocument& document, GLArea* area, MLSceneGLSharedDataContext* shared) override;
    void layerChanged(MeshDocument&, MeshModel&, GLArea*, MLSceneGLSharedDataContext*) override {}
    void decorate(MeshModel& layer, GLArea* area, QPainter* painter) override;

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

class PointCloudTools : public QObject, public pcm::host::EditBase {
    Q_OBJECT
    Q_INTERFACES(PCM_EDIT_INTERFACE)

public:
    PointCloudTools();
    QString pluginName() const override { return "EditPointCloud"; }
    ActionList actions() const override { return {actions_.begin(), actions_.end()}; }
    pcm::host::EditTool* getEditTool(PluginAction* action) override;  // one per view
    QString getEditToolDescription(PluginAction* action) override;

private:
    const pcm::host::ToolRow* row_of(PluginAction* action) const;  // null: the action is not ours

    QList<QAction*> actions_;
};
