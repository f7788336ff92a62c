#include "plugin/tools/select/select_tool.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "plugin/panels/tool_dock.h"
#include "plugin/scene/annotations.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/selected_colour.h"
#include "plugin/scene/shown_points.h"
#include "plugin/scene/text.h"
#include "plugin/tools/view_camera.h"

#include <QKeyEvent>
#include <QMainWindow>
#include <QMouseEvent>
#include <QVariantMap>

#include <algorithm>

namespace pcm::host {

namespace {

const char* const owner = "select";
constexpr int click_px = 3;        // a click does not move farther
constexpr double corner_px = 1.5;  // between corners drawn free-hand
constexpr int rest_ms = 120;       // time that the mouse rests before the brush looks at the points under it

SetOperation operation_of(Qt::KeyboardModifiers modifiers, SetOperation chosen)
{
    const bool shift = (modifiers & Qt::ShiftModifier) != 0, control = (modifiers & Qt::ControlModifier) != 0;
    if (shift && control) return SetOperation::intersect;
    return shift ? SetOperation::add : control ? SetOperation::subtract : chosen;
}

// A right button's event as one of the left, which turns the trackball.
QMouseEvent with_left_button(const QMouseEvent& event)
{
    const Qt::MouseButtons held = event.type() == QEvent::MouseButtonRelease ? Qt::NoButton : Qt::LeftButton;
    const Qt::MouseButton button = event.type() == QEvent::MouseMove ? Qt::NoButton : Qt::LeftButton;
    return QMouseEvent(event.type(), event.localPos(), event.screenPos(), button, held, Qt::NoModifier);
}

QStringList attribute_names(const PointCloud& cloud)
{
    QStringList names{"x", "y", "z"};
    for (const Attribute& attribute : cloud.info().schema) {
        if (attribute.components == 1) names << QString::fromStdString(attribute.name);
        for (std::uint32_t c = 0; attribute.components > 1 && c < attribute.components; ++c)
            names << QString("%1[%2]").arg(QString::fromStdString(attribute.name)).arg(c);
    }
    return names;
}

}  // namespace

SelectTool::SelectTool() : ViewTool("Select Points")
{
    connect(&worker_, &Worker::progressed, this, [this](double fraction, const QString& stage) {
        if (panel_) panel_->show_progress(fraction, stage);
    });
    rest_.setSingleShot(true);
    rest_.setInterval(rest_ms);
    connect(&rest_, &QTimer::timeout, this, [this] {
        if (view_) guarded([&] { look_at_brush(); });
    });
}

SelectTool::~SelectTool() { delete panel_; }

void SelectTool::publish(const QString& state)
{
    if (!view_) return;
    QVariantMap map;
    map["state"] = state;
    view_->widget().setProperty("pcm_select_tool", map);
    publish_camera(*view_);
}

bool SelectTool::start(SceneView& view)
{
    if (!take_view(view)) return false;
    if (!panel_) {
        panel_ = new SelectPanel(view_->window());
        connect(panel_, &SelectPanel::pressed, this, [this](SelectPanel::Button button) {
            if (view_) guarded([&] { press(button); });
        });
        connect(panel_, &SelectPanel::shape_changed, this, [this] {
            if (view_) guarded([&] { reset(); });
        });
    }
    panel_->show_colour(chosen_selected_colour().value_or(usual_selected_colour));
    show_dock(view, *panel_);
    connect(&view.scene().part<SceneState>(), &SceneState::selection_changed, this, &SelectTool::selection_changed,
            Qt::UniqueConnection);
    tracked_mouse_ = view.widget().hasMouseTracking();
    view.widget().setMouseTracking(true);
    view.widget().installEventFilter(this);
    view.widget().setFocus();
    view.widget().setCursor(Qt::CrossCursor);
    selection_changed();
    publish("idle");
    say("the left button selects; Shift adds, Ctrl subtracts, both intersect. The right button turns the camera, the "
        "middle one moves it. Ctrl+Z takes a selection back, Esc ends what is being done");
    return true;
}

void SelectTool::end()
{
    worker_.cancel();
    reset();
    disconnect(&view_->scene().part<SceneState>(), nullptr, this, nullptr);
    view_->widget().removeEventFilter(this);
    view_->widget().setMouseTracking(tracked_mouse_);
    hover_.reset();
    rest_.stop();
    view_->scene().part<Annotations>().set(owner, {});
    if (panel_) panel_->hide();
    publish({});
    view_ = nullptr;
}

void SelectTool::show()
{
    if (!view_ || !panel_) return;
    std::uint64_t selected = 0, all = 0;
    const SceneState& state = view_->scene().part<SceneState>();
    QStringList lines;
    for (const SceneLayer* layer : view_->scene().layers()) {
        const auto tree = layer ? layer->drawn() : std::nullopt;
        if (!tree) continue;
        const auto points = state.selection(*layer);
        const std::uint64_t count = points ? points->size() : 0, of = tree->cloud->info().points;
        selected += count;
        all += of;
        if (count > 0)
            lines << QString("%1: %2 of %3 points selected")
                         .arg(layer->label(), QString::fromStdString(grouped(count)),
                              QString::fromStdString(grouped(of)));
    }
    if (lines.empty()) lines << QString("Nothing is selected of %1 points").arg(QString::fromStdString(grouped(all)));
    if (!statistics_.isEmpty()) lines << statistics_;
    panel_->show_count(lines.join('\n'));
    const SceneLayer* current = view_->scene().current();
    const auto tree = current ? current->drawn() : std::nullopt;
    if (tree) panel_->show_attributes(attribute_names(*tree->cloud));
    const auto layer_of = [&](const std::vector<std::vector<int>>& steps) {
        return steps.empty() || steps.back().empty() ? nullptr : view_->scene().layer(steps.back().front());
    };
    const SceneLayer *last = layer_of(steps_), *next = layer_of(undone_);
    panel_->show_steps(last ? state.undo_words(*last) : QString(), next ? state.redo_words(*next) : QString());
}

ScreenShape SelectTool::brush_ring() const
{
    if (!hover_ || panel_->shape() != SelectPanel::Shape::brush) return {};
    try {
        return circle_of(*hover_, brush_px());
    } catch (const Error&) {  // what is typed is not a radius; a click reports it
        return {};
    }
}

// The shape and the brush's ring between the near and the far plane, so that they are seen from here.
void SelectTool::show_shape()
{
    const auto map = map_of(*view_);
    std::vector<Annotation> drawing;
    ScreenShape corners = shape_;
    if (cursor_) corners.push_back(*cursor_);
    for (const ScreenShape& shape : {corners, brush_ring()}) {
        if (!map || shape.size() < 2) continue;
        Annotation line;
        for (const QPointF& corner : shape) line.line.push_back(map->place_at(corner));
        line.closed = shape.size() > 2;
        line.on_top = true;
        line.colour = operation_ == SetOperation::subtract ? QColor(60, 140, 255) : QColor(255, 90, 30);
        drawing.push_back(line);
    }
    view_->scene().part<Annotations>().set(owner, std::move(drawing));
}

void SelectTool::reset()
{
    shape_.clear();
    cursor_.reset();
    waiting_.clear();
    stroke_.clear();
    picking_ = left_down_ = dragged_ = false;
    if (view_) show_shape();
}

bool SelectTool::cancel()
{
    const bool did = worker_.is_running() || !shape_.empty() || picking_ || !waiting_.empty() || left_down_;
    if (worker_.is_running()) worker_.cancel();
    reset();
    return did;
}

void SelectTool::mousePressEvent(QMouseEvent* event)
{
    using Shape = SelectPanel::Shape;
    guarded([&] {
        if (event->button() != Qt::LeftButton) {
            hover_at(std::nullopt);
            camera_turns_ = event->button() == Qt::RightButton;
            if (!camera_turns_) return view_->give_to_camera(*event);
            return view_->give_to_camera(with_left_button(*event));
        }
        left_down_ = true;
        dragged_ = false;
        pressed_at_ = event->pos();
        const Shape shape = panel_->shape();
        if (shape_.empty() && stroke_.empty() && waiting_.empty())
            operation_ = operation_of(event->modifiers(), panel_->operation());
        if (shape == Shape::rectangle) shape_ = {event->pos()};
        if (shape == Shape::lasso && shape_.empty()) shape_ = {event->pos()};
        if (shape == Shape::brush) stroke_to(event->pos(), true);
    });
}

void SelectTool::mouseMoveEvent(QMouseEvent* event)
{
    using Shape = SelectPanel::Shape;
    guarded([&] {
        if (!left_down_) {
            if (camera_turns_) return view_->give_to_camera(with_left_button(*event));
            return view_->give_to_camera(*event);
        }
        hover_at(event->pos());
        const QPointF moved = event->pos() - pressed_at_;
        const double far = std::hypot(moved.x(), moved.y());
        if (far > click_px) dragged_ = true;
        const Shape shape = panel_->shape();
        if (shape == Shape::rectangle && !shape_.empty()) {
            shape_ = rectangle_of(shape_.front(), event->pos());
            show_shape();
        } else if (shape == Shape::lasso && dragged_ && !shape_.empty()) {
            const QPointF last = shape_.back();
            if (std::hypot(event->pos().x() - last.x(), event->pos().y() - last.y()) >= corner_px)
                shape_.push_back(event->pos());
            show_shape();
        } else if (shape == Shape::brush && far >= stroke_step()) {
            stroke_to(event->pos(), false);
        }
    });
}

void SelectTool::mouseReleaseEvent(QMouseEvent* event)
{
    using Shape = SelectPanel::Shape;
    guarded([&] {
        if (event->button() != Qt::LeftButton || !left_down_) {
            if (!camera_turns_) return view_->give_to_camera(*event);
            camera_turns_ = false;
            return view_->give_to_camera(with_left_button(*event));
        }
        left_down_ = false;
        switch (panel_->shape()) {
            case Shape::rectangle:
                if (!dragged_) return reset();
                shape_ = rectangle_of(shape_.front(), event->pos());
                return finish_shape();
            case Shape::lasso:
                if (dragged_) return finish_shape();
                if (shape_.back() != QPointF(event->pos())) shape_.push_back(event->pos());
                return show_shape();
            case Shape::brush:
                if (!picking_ && waiting_.empty()) finish_stroke();
                return;
            case Shape::grow:
                if (!dragged_) stroke_to(event->pos(), true);
        }
    });
}

void SelectTool::wheelEvent(QWheelEvent* event)
{
    guarded([&] { view_->give_to_camera(*event); });
    event->accept();
}

void SelectTool::keyPressEvent(QKeyEvent* event)
{
    guarded([&] {
        if (event->matches(QKeySequence::Undo)) return event->accept(), undo(false);
        if (event->matches(QKeySequence::Redo)) return event->accept(), undo(true);
        if (shape_.empty() || panel_->shape() != SelectPanel::Shape::lasso) return;
        if (event->key() == Qt::Key_Return || event->key() == Qt::Key_Enter) {
            event->accept();
            finish_shape();
        } else if (event->key() == Qt::Key_Backspace) {
            event->accept();
            shape_.pop_back();
            show_shape();
        }
    });
}

void SelectTool::hover_at(std::optional<QPointF> place)
{
    if (panel_->shape() != SelectPanel::Shape::brush) place.reset();
    if (place == hover_) return;
    hover_ = place;
    if (place)
        rest_.start();
    else
        rest_.stop();
    show_shape();
}

bool SelectTool::eventFilter(QObject* receiver, QEvent* event)
{
    if (!view_ || receiver != &view_->widget()) return QObject::eventFilter(receiver, event);
    if (view_->is_suspended() || event->type() == QEvent::Leave) guarded([&] { hover_at(std::nullopt); });
    if (view_->is_suspended()) return QObject::eventFilter(receiver, event);
    if (event->type() == QEvent::MouseMove && static_cast<QMouseEvent*>(event)->buttons() == Qt::NoButton) {
        guarded([&] { hover_at(QPointF(static_cast<QMouseEvent*>(event)->pos())); });
        if (panel_->shape() == SelectPanel::Shape::lasso && !shape_.empty())
            guarded([&] {
                cursor_ = static_cast<QMouseEvent*>(event)->pos();
                show_shape();
            });
        return true;
    }
    if (event->type() == QEvent::MouseButtonDblClick) {
        guarded([&] {
            if (panel_->shape() == SelectPanel::Shape::lasso && !shape_.empty()) finish_shape();
        });
        return true;
    }
    if (event->type() == QEvent::ShortcutOverride && static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape) {
        bool did = false;
        guarded([&] { did = cancel(); });
        if (did) event->accept();
    }
    return QObject::eventFilter(receiver, event);
}

}  // namespace pcm::host
