#include "plugin/tools/clip/clip_tool.h"

#include "plugin/panels/tool_dock.h"
#include "plugin/scene/clip_history.h"
#include "plugin/scene/picker.h"
#include "plugin/scene/scene_bounds.h"
#include "plugin/scene/scene_view.h"
#include "plugin/scene/shown_points.h"
#include "plugin/scene/text.h"
#include "plugin/scene/tidy_numbers.h"
#include "plugin/tools/clip/clip_drawing.h"
#include "plugin/tools/view_camera.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"

#include <QKeyEvent>
#include <QMainWindow>
#include <QMouseEvent>

namespace pcm::host {

namespace {

const char* const owner = "clip";
constexpr double reach_px = 9;  // distance within which a handle is grabbed
constexpr int click_px = 3;     // a click does not move farther
constexpr double key_turn = 5;  // degrees
constexpr double fine_step = 0.1;

double steps_of(const QKeyEvent& key)
{
    const double size = (key.modifiers() & Qt::ShiftModifier) != 0 ? fine_step : 1;
    switch (key.key()) {
        case Qt::Key_Right:
        case Qt::Key_Up:
        case Qt::Key_PageUp:
            return size;
        case Qt::Key_Left:
        case Qt::Key_Down:
        case Qt::Key_PageDown:
            return -size;
        default:
            return 0;
    }
}

}  // namespace

ClipTool::~ClipTool() { delete panel_; }

const std::optional<ClipBox>& ClipTool::box() const { return view_->scene().part<SceneState>().clip(); }

ClipHistory& ClipTool::history() const { return view_->scene().part<ClipHistory>(); }

bool ClipTool::start(SceneView& view)
{
    if (!take_view(view)) return false;
    if (!panel_) {
        panel_ = new ClipPanel(view_->window());
        connect(panel_, &ClipPanel::pressed, this, [this](ClipPanel::Button button) {
            if (view_) guarded([&] { press(button); });
        });
        connect(panel_, &ClipPanel::edited, this, [this](const ClipBox& box) {
            if (view_) guarded([&] { history().keep(box); });
        });
    }
    show_dock(view, *panel_);
    connect(&view.scene().part<SceneState>(), &SceneState::clip_changed, this, &ClipTool::show, Qt::UniqueConnection);
    tracked_mouse_ = view.widget().hasMouseTracking();
    view.widget().setMouseTracking(true);
    view.widget().installEventFilter(this);
    view.widget().setFocus();
    view.widget().setCursor(Qt::ArrowCursor);
    guarded([&] {
        history();  // from here on changes can be undone
        if (!box()) take_box(bounds_in_picture(view));
        show();
    });
    say("drag a coloured cross to move a face, the white one to move the box, the violet one to turn it; R turns, the "
        "arrow keys move a slab, Space switches the box on and off, Ctrl+Z takes a change back. Everything else moves "
        "the camera");
    return true;
}

void ClipTool::end()
{
    cancel();
    disconnect(&view_->scene().part<SceneState>(), nullptr, this, nullptr);
    view_->widget().removeEventFilter(this);
    view_->widget().setMouseTracking(tracked_mouse_);
    view_->scene().part<Annotations>().set(owner, {});
    if (panel_) panel_->hide();
    hovered_.reset();
    view_ = nullptr;
}

void ClipTool::show()
{
    if (!view_) return;
    view_->scene().part<Annotations>().set(
        owner, box() ? drawing_of(*box(), dragged_ ? dragged_ : hovered_) : std::vector<Annotation>());
    publish_camera(*view_);
    if (!panel_) return;
    panel_->show_box(box(), bounds_of_shown(*view_), grid_step_of_shown(*view_));
    panel_->show_steps(history().can_undo(), history().can_redo());
}

void ClipTool::take_box(const Box3d& bounds)
{
    if (bounds.empty()) return say("no points in view; clip box unchanged");
    ClipBox made = tidied(box_around(bounds), grid_step_of_shown(*view_), true);
    if (box()) made.outside = box()->outside;
    history().keep(made);
}

void ClipTool::step(double steps)
{
    if (box() && panel_ && steps != 0) history().keep(stepped(*box(), panel_->slab_axis(), steps));
}

void ClipTool::press(ClipPanel::Button button)
{
    using Button = ClipPanel::Button;
    say({});
    switch (button) {
        case Button::from_view:
            return take_box(bounds_in_picture(*view_));
        case Button::from_layer:
            return take_box(view_->scene().current() ? bounds_of(*view_->scene().current()) : Box3d());
        case Button::box_from_points:
            return begin_picking(Picking::box);
        case Button::section_from_points:
            return begin_picking(Picking::section);
        case Button::make_slab:
            if (!box()) return;
            return history().keep(slab_of(*box(), panel_->slab_axis(),
                                          panel_->thickness().value_or(2 * box()->half[panel_->slab_axis()]),
                                          bounds_of_shown(*view_)));
        case Button::step_back:
            return step(-1);
        case Button::step_ahead:
            return step(1);
        case Button::undo:
            history().undo();
            return show();
        case Button::redo:
            history().redo();
            return show();
        case Button::remove:
            return history().keep(std::nullopt);
        case Button::keep_layer:
        case Button::keep_file:
            return keep_points(button == ClipPanel::Button::keep_layer ? SelectionUse::to_layer
                                                                       : SelectionUse::to_file);
    }
}

// The bounds of the current layer, or of the only one.
void ClipTool::keep_points(SelectionUse what)
{
    SceneLayer* layer = view_->scene().current();
    if (!layer || !layer->drawn()) {
        const auto shown = shown_layers(*view_);
        if (shown.size() != 1)
            throw Error(ErrorCode::invalid_argument, {}, "the current layer is not shown as a point cloud",
                        "click a cloud in the layer panel");
        layer = shown.front();
    }
    const QPointer<SceneView> alive(view_);
    const QString done = use_shown(*view_, *layer, what);
    if (alive && view_) say(done);
}

void ClipTool::begin_picking(Picking what)
{
    picking_ = what;
    first_point_.reset();
    view_->widget().setCursor(Qt::CrossCursor);
    view_->widget().setFocus();
    say("click the first of two points; Esc ends this");
}

void ClipTool::pick_at(const QPoint& place)
{
    pick(*view_, place, *this, [this](const PickAnswer& answer) {
        if (!view_ || picking_ == Picking::nothing || !answer.final) return;
        guarded([&] {
            if (answer.point)
                take_point(answer.point->shown_at);
            else
                say(answer.message);
        });
    });
}

void ClipTool::take_point(const Vec3d& place)
{
    if (!first_point_) {
        first_point_ = place;
        return say("click the second point; Esc ends this");
    }
    const Box3d height = bounds_of_shown(*view_);
    const Vec3d a = *first_point_;
    const Picking what = picking_;
    cancel();
    ClipBox made;
    if (what == Picking::section) {
        const double line = std::hypot(place[0] - a[0], place[1] - a[1]);
        const bool is_section = box() && box()->half[1] < line / 8;  // its thickness is kept
        made = section_between(a, place, is_section ? 2 * box()->half[1] : line / 50, height);
    } else {
        made = box_between(a, place, height);
    }
    made = tidied(made, grid_step_of_shown(*view_), what == Picking::box);
    if (box()) made.outside = box()->outside;
    say({});
    history().keep(made);
}

bool ClipTool::cancel()
{
    if (dragged_) {
        dragged_.reset();
        history().show(before_drag_);
        return true;
    }
    if (picking_ == Picking::nothing) return false;
    picking_ = Picking::nothing;
    first_point_.reset();
    view_->widget().setCursor(Qt::ArrowCursor);
    say({});
    return true;
}

void ClipTool::mousePressEvent(QMouseEvent* event)
{
    pressed_at_ = event->pos();
    guarded([&] {
        const auto map = map_of(*view_);
        if (event->button() == Qt::LeftButton && picking_ == Picking::nothing && map && box())
            dragged_ = handle_at(*box(), *map, event->pos(), reach_px);
        if (!dragged_) return view_->give_to_camera(*event);
        before_drag_ = *box();
        view_->widget().setCursor(Qt::ClosedHandCursor);
        show();
    });
}

void ClipTool::mouseMoveEvent(QMouseEvent* event)
{
    guarded([&] {
        if (!dragged_) return view_->give_to_camera(*event);
        if (const auto map = map_of(*view_))
            history().show(pcm::host::dragged(before_drag_, *dragged_, *map, pressed_at_, event->pos(),
                                              (event->modifiers() & Qt::ShiftModifier) != 0));
    });
}

void ClipTool::mouseReleaseEvent(QMouseEvent* event)
{
    guarded([&] {
        if (!dragged_) {
            view_->give_to_camera(*event);
            const bool is_click = (event->pos() - pressed_at_).manhattanLength() <= click_px;
            if (picking_ != Picking::nothing && is_click && event->button() == Qt::LeftButton) pick_at(event->pos());
            return;
        }
        dragged_.reset();
        view_->widget().setCursor(Qt::ArrowCursor);
        if (box()) history().keep(tidied(*box(), grid_step_of_shown(*view_)));
        hover(event->pos());
        show();
    });
}

void ClipTool::wheelEvent(QWheelEvent* event)
{
    guarded([&] { view_->give_to_camera(*event); });
    event->accept();
}

void ClipTool::keyPressEvent(QKeyEvent* event)
{
    guarded([&] {
        if (event->matches(QKeySequence::Undo)) return event->accept(), press(ClipPanel::Button::undo);
        if (event->matches(QKeySequence::Redo)) return event->accept(), press(ClipPanel::Button::redo);
        if ((event->modifiers() & (Qt::ControlModifier | Qt::AltModifier | Qt::MetaModifier)) != 0 || !box()) return;
        if (steps_of(*event) != 0) {
            event->accept();
            step(steps_of(*event));
        } else if (event->key() == Qt::Key_R) {
            event->accept();
            history().keep(turned(*box(), (event->modifiers() & Qt::ShiftModifier) != 0 ? -key_turn : key_turn));
        } else if (event->key() == Qt::Key_Space) {
            event->accept();
            ClipBox switched = *box();
            switched.enabled = !switched.enabled;
            history().keep(switched);
        }
    });
}

void ClipTool::hover(const QPoint& place)
{
    const auto map = map_of(*view_);
    const auto found = map && box() && picking_ == Picking::nothing ? handle_at(*box(), *map, place, reach_px)
                                                                    : std::optional<BoxHandle>();
    if (found == hovered_) return;
    hovered_ = found;
    view_->widget().setCursor(found                          ? Qt::OpenHandCursor
                              : picking_ != Picking::nothing ? Qt::CrossCursor
                                                             : Qt::ArrowCursor);
    show();
}

bool ClipTool::eventFilter(QObject* receiver, QEvent* event)
{
    if (!view_ || receiver != &view_->widget() || view_->is_suspended()) return QObject::eventFilter(receiver, event);
    if (event->type() == QEvent::MouseMove && static_cast<QMouseEvent*>(event)->buttons() == Qt::NoButton) {
        guarded([&] { hover(static_cast<QMouseEvent*>(event)->pos()); });
        return true;
    }
    if (event->type() == QEvent::MouseButtonDblClick) {
        guarded([&] { view_->give_to_camera(*event); });
        return true;
    }
    if (event->type() == QEvent::ShortcutOverride && static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape) {
        bool did = false;
        guarded([&] { did = cancel(); });
        if (did) event->accept();
        if (did) show();
    }
    return QObject::eventFilter(receiver, event);
}

}  // namespace pcm::host
