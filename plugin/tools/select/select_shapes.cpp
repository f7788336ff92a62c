// What is drawn in the view as points: the tool's work on shapes, strokes and seeds.
#include "plugin/tools/select/select_tool.h"

#include "pcm/cloud/vector.h"
#include "pcm/system/error.h"
#include "pcm/system/round_number.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/shown_points.h"
#include "plugin/scene/text.h"
#include "plugin/tools/view_camera.h"

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

constexpr double stroke_share = 0.5;  // share of the brush's radius between places of a stroke
constexpr double usual_steps = 3;     // steps of growing, in spacings
constexpr double usual_brush_px = 15, most_brush_px = 300;
constexpr double brush_steps = 4;  // steps of the brush's radius, in spacings: some 50 points of a surface

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

}  // namespace

double SelectTool::brush_px() const
{
    const auto typed = panel_->brush_px();
    return typed ? *typed : std::clamp(needed_px_, usual_brush_px, most_brush_px);
}

double SelectTool::stroke_step() const { return std::max(1.0, stroke_share * brush_px()); }

void SelectTool::look_at_brush()
{
    const bool looks = hover_ && !left_down_ && !picking_ && waiting_.empty() && !panel_->brush_px();
    if (!looks) return;
    pick(*view_, hover_->toPoint(), brush_picks_, [this](const PickAnswer& answer) {
        if (!view_ || !answer.final || !answer.point) return;
        guarded([&] {
            take_brush_place(*answer.point);
            show_shape();
        });
    });
}

void SelectTool::take_brush_place(const Picked& picked)
{
    const auto map = map_of(*view_);
    const double pixel = map ? map->pixel_size(picked.shown_at) : 0;
    if (pixel > 0) needed_px_ = brush_steps * picked.spacing_around * picked.scale / pixel;
}

std::vector<SceneLayer*> SelectTool::layers_for_shapes() const
{
    auto shown = shown_layers(*view_);
    if (panel_->all_layers()) {
        const LayerMatrices& layers = view_->scene().part<LayerMatrices>();
        const auto locked = [&](const SceneLayer* layer) { return layers.is_locked(*layer); };
        shown.erase(std::remove_if(shown.begin(), shown.end(), locked), shown.end());
        return shown;
    }
    if (shown.size() < 2) return shown;
    const auto found = std::find(shown.begin(), shown.end(), view_->scene().current());
    if (found == shown.end())
        throw Error(ErrorCode::invalid_argument, {}, "the current layer is not shown as a point cloud",
                    "click a cloud in the layer panel, or choose All shown layers");
    return {*found};
}

void SelectTool::select(const std::vector<SceneLayer*>& layers, const QString& words,
                        const std::function<Choose(const SceneLayer&)>& choice, bool grows)
{
    const SceneState& state = view_->scene().part<SceneState>();
    std::vector<SelectionTask> tasks;
    for (const SceneLayer* layer : layers) {
        SelectionTask task;
        task.layer_id = layer->id();
        task.cloud = layer->drawn()->cloud;
        task.shown = shown_points(*view_, *layer);
        task.before = state.selection(*layer);
        task.operation = operation_;
        task.choose = choice(*layer);
        if (task.choose) tasks.push_back(std::move(task));
    }
    if (tasks.empty()) return say("no layer shows a point cloud");
    say({});
    const QString what = words + words_of(operation_);
    const auto results = std::make_shared<std::vector<SelectionResult>>();
    counter_.cancel();
    worker_.start([tasks = std::move(tasks),
                   results](const ProgressFunction& progress) { *results = run_tasks(tasks, progress); },
                  [this, what, results, grows](std::exception_ptr failure) {
                      if (panel_) panel_->end_progress();
                      publish("idle");
                      guarded([&] {
                          if (failure) std::rethrow_exception(failure);
                          if (view_) take(*results, what, grows);
                      });
                  });
    publish("selecting");
}

void SelectTool::take(const std::vector<SelectionResult>& results, const QString& words, bool grown)
{
    SceneState& state = view_->scene().part<SceneState>();
    std::vector<int> changed;
    for (const SelectionResult& result : results) {
        const SceneLayer* layer = view_->scene().layer(result.layer_id);
        if (!layer) continue;
        const std::uint64_t count = result.points ? result.points->size() : 0;
        state.select(*layer, result.points, words + ", " + QString::fromStdString(grouped(count)) + " points selected");
        changed.push_back(result.layer_id);
    }
    if (changed.empty()) return;
    steps_.push_back(changed);
    undone_.clear();
    show();
    QString done = state.undo_words(*view_->scene().layer(changed.front()));
    for (const SelectionResult& result : results)
        if (grown && result.points)
            if (const std::string note = note_on_growth(*result.points); !note.empty())
                done += "\n" + QString::fromStdString(note);
    say(done);
}

void SelectTool::finish_shape()
{
    if (worker_.is_running()) {
        reset();
        throw Error(ErrorCode::invalid_argument, {}, "points are being selected",
                    "wait until it is done, or press Esc");
    }
    const ScreenShape drawn = shape_;
    const bool rectangle = panel_->shape() == SelectPanel::Shape::rectangle;
    reset();
    const auto map = map_of(*view_);
    if (!map) return say("the view has not drawn the clouds yet");
    const bool front = panel_->front_only();
    const QString words = QString(rectangle ? "rectangle" : "polygon") + (front ? ", front only" : "");
    select(layers_for_shapes(), words, [&](const SceneLayer& layer) -> Choose {
        const auto placement = layer.placement();
        if (front)
            return
                [camera = camera_for(*map, placement), polygon = polygon_of(drawn, *map)](
                    PointCloud& cloud, const Query& shown) { return points_in_front(cloud, shown, camera, polygon); };
        return [region = region_of(drawn, *map, placement)](PointCloud& cloud, const Query& shown) {
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
    const double step = stroke_step();
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
    if (answer.point && map) {
        take_brush_place(*answer.point);
        stroke_.push_back(
            {answer.point->layer_id, {answer.point->shown_at, brush_px() * map->pixel_size(answer.point->shown_at)}});
    }
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
    for (const auto& [layer_id, ball] : balls) {
        least = std::min(least, ball.radius);
        most = std::max(most, ball.radius);
    }
    const QString radius =
        QString::fromStdString(brief(least) == brief(most) ? brief(least) : brief(least) + " to " + brief(most));
    std::vector<SceneLayer*> layers;
    if (panel_->all_layers())
        layers = layers_for_shapes();
    else
        for (SceneLayer* layer : shown_layers(*view_))
            if (std::any_of(balls.begin(), balls.end(),
                            [&](const auto& picked) { return picked.first == layer->id(); }))
                layers.push_back(layer);
    select(layers, "brush of radius " + radius + " source units", [&](const SceneLayer& layer) -> Choose {
        const auto placement = layer.placement();
        std::vector<Ball> mine;
        for (const auto& [layer_id, ball] : balls)
            if (const auto moved = ball_in(ball, placement); moved && (panel_->all_layers() || layer_id == layer.id()))
                mine.push_back(*moved);
        return [mine](PointCloud& cloud, const Query& shown) { return points_in_balls(cloud, shown, mine); };
    });
}

void SelectTool::grow(const Picked& seed)
{
    SceneLayer* const layer = view_->scene().layer(seed.layer_id);
    if (!layer) return;
    const double spacing = seed.spacing_around > 0 ? seed.spacing_around : seed.spacing;
    const double usual = round_number(usual_steps * spacing), distance = panel_->distance().value_or(usual);
    panel_->propose_distance(usual > 0 ? QString::fromStdString(brief(usual)) : QString());
    const SeedLimits limits = panel_->seed_limits();
    if (!(distance > 0))
        throw Error(ErrorCode::invalid_argument, {}, "the spacing of the points is not known here",
                    "write a grow distance in source units");
    const auto words = "grown by steps of " + QString::fromStdString(brief(distance)) + " source units";
    select(
        {layer}, words,
        [&](const SceneLayer&) -> Choose {
            return [seed, distance, limits](PointCloud& cloud, const Query& shown) {
                return points_around(cloud, shown, seed.node, seed.point, distance, limits);
            };
        },
        true);
}

}  // namespace pcm::host
