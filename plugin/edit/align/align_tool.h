// The tool Align by Picked Pairs: clicks pick points, dragging and the wheel stay the camera's. Its panel has the rest.
// GUI thread.
#pragma once

#include "plugin/edit/align/align_panel.h"

#include <common/interfaces.h>

#include <QPoint>
#include <QPointer>

namespace pcm::host {

class AlignTool : public QObject, public MeshEditInterface {
    Q_OBJECT
    Q_INTERFACES(MeshEditInterface)

public:
    QString pluginName() const override { return "EditPointCloud"; }

    bool isSingleMeshEdit() const override { return false; }
    bool StartEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext* shared) override;
    void EndEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext* shared) override;
    void LayerChanged(MeshDocument&, MeshModel&, GLArea*, MLSceneGLSharedDataContext*) override {}

    void mousePressEvent(QMouseEvent* event, MeshModel&, GLArea* view) override;
    void mouseMoveEvent(QMouseEvent* event, MeshModel&, GLArea* view) override;
    void mouseReleaseEvent(QMouseEvent* event, MeshModel&, GLArea* view) override;
    void wheelEvent(QWheelEvent* event, MeshModel&, GLArea* view) override;
    void keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* view) override;

private:
    void pick_at(const QPoint& place);

    GLArea* view_ = nullptr;  // while the tool is on
    QPointer<AlignPanel> panel_;
    QPoint pressed_at_;
    bool pressed_ = false, dragged_ = false;
};

}  // namespace pcm::host
