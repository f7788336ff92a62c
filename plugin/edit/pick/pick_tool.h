// The tool Pick Point: a click shows all that is known about the point under the cursor.
//
// A click without a movement picks; dragging and the wheel move MeshLab's camera. GUI thread; points are searched on a
// thread of their own (host/picker.h).
#pragma once

#include "plugin/edit/pick/pick_panel.h"
#include "plugin/host/picker.h"

#include "plugin/edit/click_tool.h"

#include <QPointer>

#include <functional>
#include <memory>
#include <optional>

namespace pcm::host {

class PickTool : public ClickTool {
    Q_OBJECT
    Q_INTERFACES(MeshEditInterface)

public:
    PickTool() : ClickTool("Pick Point") {}
    ~PickTool() override;
    bool StartEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext* shared) override;
    void EndEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext* shared) override;

    void keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* view) override;

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
    std::vector<PickedLine> lines_;     // of it
    std::unique_ptr<QObject> context_;  // of the picks; made anew with each start of the tool
    int answers_ = 0;
};

}  // namespace pcm::host
