// The tool Select Points: rectangles, polygons, a brush and growing in the view, and the panel with what is done with
// the selected points.
//
// The left button selects. The right button turns MeshLab's camera, the middle one moves it, the wheel zooms. Points
// are found on a worker (worker.h); the result goes to scene/scene_state.h. GUI thread.
#pragma once

#include "plugin/scene/picker.h"
#include "plugin/scene/worker.h"
#include "plugin/tools/select/screen_shape.h"
#include "plugin/tools/select/select_panel.h"
#include "plugin/tools/select/selection_tasks.h"
#include "plugin/tools/selection_uses.h"

#include "plugin/tools/view_tool.h"

#include <QPointer>
#include <QTimer>

#include <deque>
#include <functional>
#include <optional>
#include <vector>

namespace pcm::host {

class SelectTool : public ViewTool {
    Q_OBJECT

public:
    SelectTool();
    ~SelectTool() override;
    bool start(SceneView& view) override;
    void end() override;

    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

protected:
    // Double clicks, moves without a button, and Esc, which MeshLab has as a shortcut.
    bool eventFilter(QObject* receiver, QEvent* event) override;

private:
    using Choose = std::function<PointSet(PointCloud& cloud, const Query& shown)>;
    void say_in_panel(const QString& text) override
    {
        if (panel_) panel_->say(text);
    }
    void show();
    void show_shape();
    void hover_at(std::optional<QPointF> place);
    ScreenShape brush_ring() const;  // around the cursor; empty: none is shown
    double brush_px() const;         // what is typed, or what the points under the cursor need
    void look_at_brush();            // finds that out where the mouse rests
    void take_brush_place(const Picked& picked);
    void publish(const QString& state);
    void press(SelectPanel::Button button);
    void undo(bool again);
    bool cancel();  // what is being drawn or computed; false if nothing is
    void reset();

    std::vector<SceneLayer*> layers_for_shapes() const;
    void finish_shape();
    double stroke_step() const;  // pixels
    void stroke_to(const QPoint& place, bool first);
    void pick_next();
    void take_picked(const PickAnswer& answer);
    void finish_stroke();
    void grow(const Picked& seed);
    // `choice` makes the function for each layer.
    void select(const std::vector<SceneLayer*>& layers, const QString& words,
                const std::function<Choose(const SceneLayer&)>& choice, bool grows = false);
    void take(const std::vector<SelectionResult>& results, const QString& words, bool grown);
    void count();
    void choose_colour();
    void use(SelectionUse what);
    void selection_changed();

    QPointer<SelectPanel> panel_;
    Worker worker_{"points are being selected"};
    Worker counter_{"points are being counted"};  // finds what is known about the selected ones
    QString statistics_;                          // statistics of the selection that is shown
    bool tracked_mouse_ = false;

    ScreenShape shape_;              // being drawn
    std::optional<QPointF> cursor_;  // the corner that follows the mouse
    std::optional<QPointF> hover_;   // where the mouse is, while it does not move the camera
    QTimer rest_;                    // since the mouse has moved with the brush
    QObject brush_picks_;            // the context of the brush's looks
    double needed_px_ = 0;           // radius of a brush that holds enough points, at the last place
    bool left_down_ = false, dragged_ = false, camera_turns_ = false;
    QPoint pressed_at_;
    SetOperation operation_ = SetOperation::replace;  // when the shape was begun

    std::deque<QPoint> waiting_;  // places of the stroke that are to be picked
    bool picking_ = false;
    std::vector<std::pair<int, Ball>> stroke_;      // in the scene, by the layer that was picked
    std::vector<std::vector<int>> steps_, undone_;  // the layers that each step changed
};

}  // namespace pcm::host
