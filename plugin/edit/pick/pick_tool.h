// The tool Pick Point: a click shows all that is known about the point under the cursor.
//
// A click without a movement picks; dragging and the wheel move MeshLab's camera. GUI thread; points are searched on a
// thread of their own (host/picker.h).
#pragma once

#include "plugin/edit/pick/pick_panel.h"
#include "plugin/host/picker.h"

#include <common/interfaces.h>

#include <QPointer>

#include <functional>
#include <memory>
#include <optional>

class QMouseEvent;

namespace pcm::host {

class PickTool : public QObject, public MeshEditInterface {
    Q_OBJECT
    Q_INTERFACES(MeshEditInterface)

public:
    ~PickTool() override;
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

protected:
    // Ctrl+C, which MeshLab may have as a shortcut.
    bool eventFilter(QObject* receiver, QEvent* event) override;

private:
    void guarded(const std::function<void()>& work);
    void say(const QString& text);
    void click(const QPoint& place);
    void take(const PickAnswer& answer);
    void show_point(bool complete);
    void copy();
    // For observers such as tests.
    void publish(const PickAnswer& answer);

    GLArea* view_ = nullptr;  // while the tool is on
    QPointer<PickPanel> panel_;
    std::optional<Picked> shown_;           // the last exact answer
    std::vector<PickedLine> lines_;         // of it
    std::unique_ptr<QObject> context_;      // of the picks; made anew with each start of the tool
    std::unique_ptr<QMouseEvent> pressed_;  // has not moved far enough for a drag
    int answers_ = 0;
};

}  // namespace pcm::host
