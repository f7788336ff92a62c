// The tool Align by Picked Pairs: clicks pick points, dragging and the wheel stay the camera's. Its panel has the rest.
// GUI thread.
#pragma once

#include "plugin/tools/align/align_panel.h"
#include "plugin/tools/click_tool.h"

#include <QPointer>

namespace pcm::host {

class AlignTool : public ClickTool {
    Q_OBJECT

public:
    AlignTool() : ClickTool("Align by Picked Pairs") {}
    bool start(SceneView& view) override;
    void end() override;

    void keyPressEvent(QKeyEvent* event) override;

private:
    void say_in_panel(const QString& text) override
    {
        if (panel_) panel_->say(text);
    }
    void click(const QPoint& place, Qt::KeyboardModifiers modifiers) override;

    QPointer<AlignPanel> panel_;
};

}  // namespace pcm::host
