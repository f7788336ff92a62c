// The tool Align by Picked Pairs: clicks pick points, dragging and the wheel stay the camera's. Its panel has the rest.
// GUI thread.
#pragma once

#include "plugin/edit/align/align_panel.h"
#include "plugin/edit/click_tool.h"

#include <QPointer>

namespace pcm::host {

class AlignTool : public ClickTool {
    Q_OBJECT
    Q_INTERFACES(MeshEditInterface)

public:
    AlignTool() : ClickTool("Align by Picked Pairs") {}
    bool StartEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext* shared) override;
    void EndEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext* shared) override;

    void keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* view) override;

private:
    void say_in_panel(const QString& text) override
    {
        if (panel_) panel_->say(text);
    }
    void click(const QPoint& place, Qt::KeyboardModifiers modifiers) override;

    QPointer<AlignPanel> panel_;
};

}  // namespace pcm::host
