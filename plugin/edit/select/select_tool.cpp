#include "plugin/edit/select/select_tool.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "plugin/edit/scene_bounds.h"
#include "plugin/edit/select/shown_points.h"
#include "plugin/edit/tool_dock.h"
#include "plugin/edit/view_events.h"
#include "plugin/host/annotations.h"
#include "plugin/host/placement.h"
#include "plugin/host/scene_state.h"
#include "plugin/host/text.h"

#include <meshlab/glarea.h>

#include <QKeyEvent>
#include <QMainWindow>
#include <QMouseEvent>
#include <QVariantMap>

#include <algorithm>

namespace pcm::host {

namespace {

const char* const name = "Select Points";
const char* const owner = "select";
constexpr int click_px = 3;           // a click does not move farther
constexpr double corner_px = 1.5;     // between corners drawn free-hand
constexpr double stroke_share = 0.5;  // of the brush's radius, between places of a stroke
constexpr double usual_steps = 3;     // of growing, in spacings

SetOperation operation_of(Qt::KeyboardModifiers modifiers, SetOperation chosen)
{
    const bool shift = (modifiers & Qt::ShiftModifier) != 0, control = (modifiers & Qt::ControlModifier) != 0;
    if (shift && control) return SetOperation::intersect;
    return shift ? SetOperation::add : control ? SetOperation::subtract : chosen;
}

QString words_of(SetOperation operation)
{
    switch (operation) {
        case SetOperation::add:
            return " added";
        case SetOperation::subtract:
            return " subtracted";
        case SetOperation::intersect:
            return " intersected";
        default:
            return {};
    }
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

SelectTool::SelectTool()
{
    connect(&job_, &SelectionJob::progressed, this, [this](double fraction, const QString& stage) {
        if (panel_) panel_->show_progress(fraction, stage);
    });
}

SelectTool::~SelectTool() { delete panel_; }

// Qt does not allow exceptions in event handlers.
void SelectTool::guarded(const std::function<void()>& work)
{
    try {
        work();
    } catch (...) {
        say(QString::fromStdString(current_error()));
    }
}

void SelectTool::say(const QString& text)
{
    if (panel_) panel_->say(text);
    if (view_ && !text.isEmpty())
        view_->md()->Log.Log(GLLogStream::SYSTEM, qPrintable(QString("%1: %2").arg(name, text)));
}

void SelectTool::publish(const QString& state)
{
    if (!view_) return;
    QVariantMap map;
    map["state"] = state;
    view_->setProperty("pcm_select_tool", map);
    publish_camera(*view_);
}

bool SelectTool::StartEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext*)
{
    view_ = view;
    setParent(view);  // the view does not delete its tools otherwise
    if (bounds_of_shown(*view).empty()) {
        say("no layer shows a point cloud");
        view_ = nullptr;
        return false;
    }
    if (!panel_) {
        panel_ = new SelectPanel(window_of(*view));
        connect(panel_, &SelectPanel::pressed, this, [this](SelectPanel::Button button) {
            if (view_) guarded([&] { press(button); });
        });
        connect(panel_, &SelectPanel::shape_changed, this, [this] {
            if (view_) guarded([&] { reset(); });
        });
    }
    show_dock(*view, *panel_);
    connect(&SceneState::of(document), &SceneState::selection_changed, this, &SelectTool::show, Qt::UniqueConnection);
    tracked_mouse_ = view->hasMouseTracking();
    view->setMouseTracking(true);
    view->installEventFilter(this);
    view->setFocus();
    view->setCursor(Qt::CrossCursor);
    keep_unmodified(document);
    show();
    publish("idle");
    say("the left button selects; Shift adds, Ctrl subtracts, both intersect. The right button turns the camera, the "
        "middle one moves it. Ctrl+Z takes a selection back, Esc ends what is being done");
    return true;
}

void SelectTool::EndEdit(MeshDocument& document, GLArea* view, MLSceneGLSharedDataContext*)
{
    if (view != view_) return;
    job_.cancel();
    reset();
    disconnect(&SceneState::of(document), nullptr, this, nullptr);
    view->removeEventFilter(this);
    view->setMouseTracking(tracked_mouse_);
    Annotations::of(document).set(owner, {});
    if (panel_) panel_->hide();
    publish({});
    view_ = nullptr;
}

void SelectTool::show()
{
    if (!view_ || !panel_) return;
    std::uint64_t selected = 0, all = 0;
    const SceneState& state = SceneState::of(*view_->md());
    QStringList lines;
    for (const MeshModel* layer : view_->md()->meshList) {
        const auto tree = layer ? Registry::instance().drawn(*layer) : std::nullopt;
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
    panel_->show_count(lines.join('\n'));
    const MeshModel* current = view_->md()->mm();
    const auto tree = current ? Registry::instance().drawn(*current) : std::nullopt;
    if (tree) panel_->show_attributes(attribute_names(*tree->cloud));
    const auto layer_of = [&](const std::vector<std::vector<int>>& steps) {
        return steps.empty() || steps.back().empty() ? nullptr : view_->md()->getMesh(steps.back().front());
    };
    const MeshModel *last = layer_of(steps_), *next = layer_of(undone_);
    panel_->show_steps(last ? state.undo_words(*last) : QString(), next ? state.redo_words(*next) : QString());
}

// The shape between the near and the far plane, so that it is seen from here.
void SelectTool::draw()
{
    const auto map = map_of(*view_);
    std::vector<Annotation> drawing;
    ScreenShape corners = shape_;
    if (cursor_) corners.push_back(*cursor_);
    if (map && corners.size() > 1) {
        Annotation line;
        for (const QPointF& corner : corners) line.line.push_back(map->place_at(corner));
        line.closed = corners.size() > 2;
        line.on_top = true;
        line.colour = operation_ == SetOperation::subtract ? QColor(60, 140, 255) : QColor(255, 90, 30);
        drawing.push_back(line);
    }
    Annotations::of(*view_->md()).set(owner, std::move(drawing));
}

void SelectTool::reset()
{
    shape_.clear();
    cursor_.reset();
    waiting_.clear();
    stroke_.clear();
    picking_ = left_down_ = dragged_ = false;
    if (view_) draw();
}

bool SelectTool::cancel()
{
    const bool did = job_.is_running() || !shape_.empty() || picking_ || !waiting_.empty() || left_down_;
    if (job_.is_running()) job_.cancel();
    reset();
    return did;
}

std::vector<MeshModel*> SelectTool::layers_for_shapes() const
{
    const auto shown = shown_layers(*view_);
    if (panel_->all_layers() || shown.size() < 2) return shown;
    const auto found = std::find(shown.begin(), shown.end(), view_->md()->mm());
    if (found == shown.end())
        throw Error(ErrorCode::invalid_argument, {}, "the current layer is not shown as a point cloud",
                    "click a cloud in the layer panel, or choose All shown layers");
    return {*found};
}

void SelectTool::select(const std::vector<MeshModel*>& layers, const QString& words,
                        const std::function<Choose(const MeshModel&)>& choice)
{
    const SceneState& state = SceneState::of(*view_->md());
    std::vector<SelectionTask> tasks;
    for (const MeshModel* layer : layers) {
        SelectionTask task;
        task.mesh_id = layer->id();
        task.cloud = Registry::instance().drawn(*layer)->cloud;
        task.shown = shown_points(*view_, *layer);
        task.before = state.selection(*layer);
        task.operation = operation_;
        task.choose = choice(*layer);
        if (task.choose) tasks.push_back(std::move(task));
    }
    if (tasks.empty()) return say("no layer shows a point cloud");
    say({});
    const QString what = words + words_of(operation_);
    job_.start(std::move(tasks), [this, what](std::vector<SelectionResult> results, std::exception_ptr failure) {
        if (panel_) panel_->end_progress();
        publish("idle");
        guarded([&] {
            if (failure) std::rethrow_exception(failure);
            if (view_) take(results, what);
        });
    });
    publish("selecting");
}

void SelectTool::take(const std::vector<SelectionResult>& results, const QString& words)
{
    SceneState& state = SceneState::of(*view_->md());
    std::vector<int> changed;
    for (const SelectionResult& result : results) {
        const MeshModel* layer = view_->md()->getMesh(result.mesh_id);
        if (!layer) continue;
        const std::uint64_t count = result.points ? result.points->size() : 0;
        state.select(*layer, result.points, words + ", " + QString::fromStdString(grouped(count)) + " points selected");
        changed.push_back(result.mesh_id);
    }
    if (changed.empty()) return;
    steps_.push_back(changed);
    undone_.clear();
    show();
    say(state.undo_words(*view_->md()->getMesh(changed.front())));
}

void SelectTool::undo(bool again)
{
    auto &from = again ? undone_ : steps_, &to = again ? steps_ : undone_;
    if (from.empty()) return;
    SceneState& state = SceneState::of(*view_->md());
    const std::vector<int> ids = from.back();
    from.pop_back();
    to.push_back(ids);
    for (const int mesh_id : ids)
        if (const MeshModel* layer = view_->md()->getMesh(mesh_id)) again ? state.redo(*layer) : state.undo(*layer);
    show();
}

void SelectTool::finish_shape()
{
    if (job_.is_running()) {
        reset();
        throw Error(ErrorCode::invalid_argument, {}, "points are being selected",
                    "wait until it is done, or press Esc");
    }
    const ScreenShape drawn = shape_;
    const bool rectangle = panel_->shape() == SelectPanel::Shape::rectangle;
    reset();
    const auto map = map_of(*view_);
    if (!map) return;
    if (panel_->front_only()) throw Error(ErrorCode::unsupported, {}, "Front only is not there yet");
    select(layers_for_shapes(), rectangle ? "rectangle" : "polygon", [&](const MeshModel& layer) -> Choose {
        const auto tree = Registry::instance().drawn(layer);
        const Region region = region_of(drawn, *map, placement_of(layer, *tree));
        return [region](PointCloud& cloud, const Query& shown) {
            Query query = shown;
            query.region = region;
            return points_of(cloud, query);
        };
    });
}

// With places between the last one and this, so that a quick stroke has no gaps.
void SelectTool::stroke_to(const QPoint& place, bool first)
{
    const QPointF moved = place - pressed_at_;
    const double step = std::max(1.0, stroke_share * panel_->brush_px());
    const int steps = first ? 1 : std::max(1, static_cast<int>(std::hypot(moved.x(), moved.y()) / step));
    for (int i = 1; i <= steps; ++i) waiting_.push_back(first ? place : pressed_at_ + (moved * i / steps).toPoint());
    pressed_at_ = place;
    pick_next();
}

// One pick after the other: a later pick replaces one that is not answered.
void SelectTool::pick_next()
{
    if (picking_ || waiting_.empty()) return;
    picking_ = true;
    publish("picking");
    const QPoint place = waiting_.front();
    waiting_.pop_front();
    pick(*view_, place, *this, [this](const PickAnswer& answer) {
        if (view_ && picking_ && answer.final) guarded([&] { take_picked(answer); });
    });
}

void SelectTool::take_picked(const PickAnswer& answer)
{
    picking_ = false;
    if (panel_->shape() == SelectPanel::Shape::grow) {
        publish("idle");
        reset();
        if (!answer.point) return say(answer.message);
        return grow(*answer.point);
    }
    const auto map = map_of(*view_);
    if (answer.point && map)
        stroke_.push_back({answer.point->mesh_id,
                           {answer.point->shown_at, panel_->brush_px() * map->pixel_size(answer.point->shown_at)}});
    if (!waiting_.empty()) return pick_next();
    if (!left_down_) finish_stroke();
}

void SelectTool::finish_stroke()
{
    publish("idle");
    const auto balls = stroke_;
    reset();
    if (balls.empty()) return say("the brush has met no point");
    double least = balls.front().second.radius, most = least;
    for (const auto& [mesh_id, ball] : balls) {
        least = std::min(least, ball.radius);
        most = std::max(most, ball.radius);
    }
    const QString radius =
        QString::fromStdString(brief(least) == brief(most) ? brief(least) : brief(least) + " to " + brief(most));
    std::vector<MeshModel*> layers;
    for (MeshModel* layer : shown_layers(*view_))
        if (panel_->all_layers() ||
            std::any_of(balls.begin(), balls.end(), [&](const auto& picked) { return picked.first == layer->id(); }))
            layers.push_back(layer);
    select(layers, "brush of radius " + radius + " source units", [&](const MeshModel& layer) -> Choose {
        const auto placement = placement_of(layer, *Registry::instance().drawn(layer));
        std::vector<Ball> mine;
        for (const auto& [mesh_id, ball] : balls)
            if (const auto moved = ball_in(ball, placement); moved && (panel_->all_layers() || mesh_id == layer.id()))
                mine.push_back(*moved);
        return [mine](PointCloud& cloud, const Query& shown) { return points_in_balls(cloud, shown, mine); };
    });
}

void SelectTool::grow(const Picked& seed)
{
    MeshModel* const layer = view_->md()->getMesh(seed.mesh_id);
    if (!layer) return;
    const double distance = panel_->distance().value_or(usual_steps * seed.spacing);
    if (!(distance > 0))
        throw Error(ErrorCode::invalid_argument, {}, "the spacing of the points is not known here",
                    "write a grow distance in source units");
    const auto words = "grown by steps of " + QString::fromStdString(brief(distance)) + " source units";
    select({layer}, words, [&](const MeshModel&) -> Choose {
        return [seed, distance](PointCloud& cloud, const Query& shown) {
            return points_around(cloud, shown, seed.node, seed.point, distance);
        };
    });
}

void SelectTool::press(SelectPanel::Button button)
{
    using Button = SelectPanel::Button;
    say({});
    operation_ = panel_->operation();
    const auto everywhere = [this](const Choose& choose) { return [choose](const MeshModel&) { return choose; }; };
    switch (button) {
        case Button::where: {
            std::vector<Condition> where;
            for (const QString& text : panel_->where().split(';', Qt::SkipEmptyParts))
                if (!text.trimmed().isEmpty()) where.push_back(parse_condition(text.trimmed().toStdString()));
            if (where.empty())
                throw Error(ErrorCode::invalid_argument, {}, "there is no condition",
                            "write one, as in classification=2");
            return select(layers_for_shapes(), panel_->where(),
                          everywhere([where](PointCloud& cloud, const Query& shown) {
                              Query query = shown;
                              query.where.insert(query.where.end(), where.begin(), where.end());
                              return points_of(cloud, query);
                          }));
        }
        case Button::all:
            operation_ = SetOperation::replace;
            return select(layers_for_shapes(), "all shown", everywhere(points_of));
        case Button::none:
            operation_ = SetOperation::replace;
            return select(layers_for_shapes(), "none",
                          everywhere([](PointCloud& cloud, const Query&) { return PointSet(cloud.tree()); }));
        case Button::invert:
            operation_ = SetOperation::replace;
            return select(layers_for_shapes(), "inverted", [this](const MeshModel& layer) -> Choose {
                const auto before = SceneState::of(*view_->md()).selection(layer);
                return [before](PointCloud& cloud, const Query& shown) {
                    PointSet set = points_of(cloud, shown);
                    if (before) set.combine(SetOperation::subtract, *before);
                    return set;
                };
            });
        case Button::undo:
        case Button::redo:
            return undo(button == Button::redo);
        case Button::stop:
            cancel();
            return;
        default:
            return;
    }
}

void SelectTool::mousePressEvent(QMouseEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    using Shape = SelectPanel::Shape;
    guarded([&] {
        if (event->button() != Qt::LeftButton) {
            camera_turns_ = event->button() == Qt::RightButton;
            if (!camera_turns_) return give_to_camera(*view, *event);
            return give_to_camera(*view, with_left_button(*event));
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

void SelectTool::mouseMoveEvent(QMouseEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    using Shape = SelectPanel::Shape;
    guarded([&] {
        if (!left_down_) {
            if (camera_turns_) return give_to_camera(*view, with_left_button(*event));
            return give_to_camera(*view, *event);
        }
        const QPointF moved = event->pos() - pressed_at_;
        const double far = std::hypot(moved.x(), moved.y());
        if (far > click_px) dragged_ = true;
        const Shape shape = panel_->shape();
        if (shape == Shape::rectangle && !shape_.empty()) {
            shape_ = rectangle_of(shape_.front(), event->pos());
            draw();
        } else if (shape == Shape::lasso && dragged_ && !shape_.empty()) {
            const QPointF last = shape_.back();
            if (std::hypot(event->pos().x() - last.x(), event->pos().y() - last.y()) >= corner_px)
                shape_.push_back(event->pos());
            draw();
        } else if (shape == Shape::brush && far >= std::max(1.0, stroke_share * panel_->brush_px())) {
            stroke_to(event->pos(), false);
        }
    });
}

void SelectTool::mouseReleaseEvent(QMouseEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    using Shape = SelectPanel::Shape;
    guarded([&] {
        if (event->button() != Qt::LeftButton || !left_down_) {
            if (!camera_turns_) return give_to_camera(*view, *event);
            camera_turns_ = false;
            return give_to_camera(*view, with_left_button(*event));
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
                return draw();
            case Shape::brush:
                if (!picking_ && waiting_.empty()) finish_stroke();
                return;
            case Shape::grow:
                if (!dragged_) stroke_to(event->pos(), true);
        }
    });
}

void SelectTool::wheelEvent(QWheelEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
    guarded([&] { give_to_camera(*view, *event); });
    event->accept();
}

void SelectTool::keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* view)
{
    if (view != view_) return;
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
            draw();
        }
    });
}

bool SelectTool::eventFilter(QObject* receiver, QEvent* event)
{
    if (receiver != view_ || !view_ || view_->suspendedEditor) return QObject::eventFilter(receiver, event);
    if (event->type() == QEvent::MouseMove && static_cast<QMouseEvent*>(event)->buttons() == Qt::NoButton) {
        if (panel_->shape() == SelectPanel::Shape::lasso && !shape_.empty())
            guarded([&] {
                cursor_ = static_cast<QMouseEvent*>(event)->pos();
                draw();
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
