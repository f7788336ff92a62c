// The panel's part of the tool: what its buttons do, and what is known about the selected points.
#include "plugin/tools/select/select_tool.h"

#include "pcm/cloud/condition.h"
#include "pcm/filter/set_points.h"
#include "pcm/system/error.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/selected_colour.h"
#include "plugin/scene/text.h"
#include "plugin/scene/tidy_numbers.h"

#include <QColorDialog>

namespace pcm::host {

void SelectTool::undo(bool again)
{
    auto &from = again ? undone_ : steps_, &to = again ? steps_ : undone_;
    if (from.empty()) return;
    SceneState& state = view_->scene().part<SceneState>();
    const std::vector<int> ids = from.back();
    from.pop_back();
    to.push_back(ids);
    for (const int layer_id : ids)
        if (const SceneLayer* layer = view_->scene().layer(layer_id)) again ? state.redo(*layer) : state.undo(*layer);
    show();
}

void SelectTool::press(SelectPanel::Button button)
{
    using Button = SelectPanel::Button;
    say({});
    operation_ = panel_->operation();
    const auto everywhere = [this](const Choose& choose) { return [choose](const SceneLayer&) { return choose; }; };
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
            return select(layers_for_shapes(), "inverted", [this](const SceneLayer& layer) -> Choose {
                const auto before = view_->scene().part<SceneState>().selection(layer);
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
        case Button::defaults:
            return panel_->show_defaults();
        case Button::colour:
            return choose_colour();
        case Button::to_layer:
            return use(SelectionUse::to_layer);
        case Button::to_file:
            return use(SelectionUse::to_file);
        case Button::remove:
            return use(SelectionUse::remove);
        case Button::classify:
            return use(SelectionUse::classify);
        case Button::save:
            return use(SelectionUse::save);
    }
}

void SelectTool::choose_colour()
{
    const QColor now = chosen_selected_colour().value_or(usual_selected_colour);
    const QPointer<SceneView> alive(view_);
    const QColor chosen =
        QColorDialog::getColor(now, panel_, "Colour of selected points", QColorDialog::DontUseNativeDialog);
    if (!chosen.isValid() || !alive || !view_) return;
    choose_selected_colour(chosen, view_->scene());
    panel_->show_colour(chosen);
}

// The current layer's selection, else the only one.
void SelectTool::use(SelectionUse what)
{
    if (worker_.is_running())
        throw Error(ErrorCode::invalid_argument, {}, "points are being selected",
                    "wait until it is done, or press Esc");
    const SceneState& state = view_->scene().part<SceneState>();
    SceneLayer* layer = view_->scene().current();
    if (!layer || !state.selection(*layer)) {
        std::vector<SceneLayer*> selected;
        for (SceneLayer* other : view_->scene().layers())
            if (state.selection(*other)) selected.push_back(other);
        if (selected.size() != 1)
            throw Error(ErrorCode::invalid_argument, {},
                        selected.empty() ? "no point is selected" : "points of several layers are selected",
                        selected.empty() ? "select points first" : "make one of them the current layer");
        layer = selected.front();
    }
    counter_.cancel();
    const QPointer<SceneView> alive(view_);
    const QString before = state.undo_words(*layer);
    const QString done = use_selected(*view_, *layer, what);
    if (!alive || !view_) return;
    // What was used may have been cleared (scene/result_layer.h): a step that undo takes back.
    if (state.undo_words(*layer) != before) {
        steps_.push_back({layer->id()});
        undone_.clear();
    }
    publish("idle");
    show();
    say(done);
}

void SelectTool::selection_changed()
{
    statistics_.clear();
    show();
    count();
}

// Where the selected points of the current layer are, and which classes they have; computed while the view works.
void SelectTool::count()
{
    const SceneLayer* layer = view_ ? view_->scene().current() : nullptr;
    const auto set = layer ? view_->scene().part<SceneState>().selection(*layer) : nullptr;
    counter_.cancel();
    if (!set || counter_.is_running()) return;  // the one that ends counts again
    const auto found = std::make_shared<SetStatistics>();
    counter_.start(
        [set, found](const ProgressFunction& progress) { *found = statistics_of(*set, 1, progress); },
        [this, set, found](std::exception_ptr failure) {
            if (!view_ || !panel_) return;
            const SceneLayer* now = view_->scene().current();
            if (!now || view_->scene().part<SceneState>().selection(*now) != set) return count();
            guarded([&] {
                if (failure) std::rethrow_exception(failure);
                const Vec3d& step = set->tree().info().grid.scale;
                QStringList lines;
                for (std::size_t a = 0; a < 3; ++a)
                    lines << QString("%1 from %2 to %3")
                                 .arg("xyz"[a])
                                 .arg(on_grid_text(found->box.min[a], step[a]),
                                      on_grid_text(found->box.max[a], step[a]));
                for (const auto& [number, points] : found->classes)
                    lines << QString("class %1: %2").arg(number).arg(QString::fromStdString(grouped(points)));
                statistics_ = lines.join('\n');
                show();
            });
        });
}

}  // namespace pcm::host
