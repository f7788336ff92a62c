// The tool Pick Point: a click shows all that is known about the point under the cursor.
//
// A click without a movement picks; dragging and the wheel move MeshLab's camera. GUI thread; points are searched on a
// thread of their own (scene/picker.h).
#pragma once

#include "plugin/scene/picker.h"
#include "plugin/tools/pick/pick_panel.h"

#include "plugin/tools/click_tool.h"

#include <QPointer>

#include <functional>
#include <memory>
#include <optional>

namespace pcm::host {

class PickTool : public ClickTool {
    Q_OBJECT

public:
    PickTool() : ClickTool("Pick Point") {}
    ~PickTool() override;
    bool start(SceneView& view) override;
    void end() override;

    void keyPressEvent(QKeyEvent* event) override;

protected:
    // Ctrl+C, which MeshLab may have as a shortcut.
    bool eventFilter(QObject* receiver, QEvent* event) override;

private:
    void say_in_panel(const QString& text) override
    {
        if (panel_) panel_->say(text);
    }
    void click(const QPoint& place, Qt::KeyboardModifiers modifiers) override;
    void take(const PickAnswer& answer);
    void show_point(bool complete);
    void copy();
    // For observers such as tests.
    void publish(const PickAnswer& answer);

    QPointer<PickPanel> panel_;
    std::optional<Picked> shown_;       // the last exact answer
    std::vector<PickedLine> lines_;     // its lines
    std::unique_ptr<QObject> context_;  // context of the picks; a new one with each start of the tool
    int answers_ = 0;
};

}  // namespace pcm::host
