// The tool Clip Box: the box of the document as edges and handles in the view, and its panel.
//
// A handle is dragged; everything else goes to MeshLab's camera. Ending the tool keeps the box. GUI thread.
#pragma once

#include "plugin/tools/clip/box_handles.h"
#include "plugin/tools/clip/clip_panel.h"
#include "plugin/tools/selection_uses.h"

#include "plugin/tools/view_tool.h"

#include <QPointer>

#include <functional>
#include <optional>

namespace pcm::host {

class ClipHistory;

class ClipTool : public ViewTool {
    Q_OBJECT

public:
    ClipTool() : ViewTool("Clip Box") {}
    ~ClipTool() override;
    bool start(SceneView& view) override;
    void end() override;

    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

protected:
    // Moves without a button, double clicks, and Esc, which MeshLab has as a shortcut.
    bool eventFilter(QObject* receiver, QEvent* event) override;

private:
    enum class Picking { nothing, box, section };
    const std::optional<ClipBox>& box() const;
    ClipHistory& history() const;
    void say_in_panel(const QString& text) override
    {
        if (panel_) panel_->say(text);
    }
    void show();  // in the panel and in the view
    void press(ClipPanel::Button button);
    void take_box(const Box3d& bounds);
    void keep_points(SelectionUse what);
    void step(double steps);
    void begin_picking(Picking what);
    void pick_at(const QPoint& place);
    void take_point(const Vec3d& place);
    bool cancel();  // what is being done; false if nothing is
    void hover(const QPoint& place);

    QPointer<ClipPanel> panel_;
    std::optional<BoxHandle> dragged_, hovered_;
    ClipBox before_drag_;
    QPoint pressed_at_;
    bool tracked_mouse_ = false;
    Picking picking_ = Picking::nothing;
    std::optional<Vec3d> first_point_;
};

}  // namespace pcm::host
