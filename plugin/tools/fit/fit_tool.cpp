#include "plugin/tools/fit/fit_tool.h"

#include "pcm/system/error.h"
#include "plugin/panels/tool_dock.h"
#include "plugin/scene/annotations.h"
#include "plugin/scene/drawn_primitives.h"
#include "plugin/scene/length_unit.h"
#include "plugin/scene/look_at.h"
#include "plugin/scene/primitive_book.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/shown_points.h"
#include "plugin/scene/text.h"
#include "plugin/tools/fit/same_shape.h"
#include "plugin/tools/view_camera.h"

#include <QMainWindow>
#include <QMouseEvent>
#include <QVariantMap>

namespace pcm::host {

namespace {

const char* const draft_owner = "fit draft";
const QColor draft_colour(90, 220, 255);
constexpr double filled_by_primitive = 0.7;  // share of the view
QString counted(std::size_t count, const char* what)
{
    return QString("%1 %2%3").arg(count).arg(what).arg(count == 1 ? "" : "s");
}

Box3d box_in_scene(const PrimitiveBook& book, const Primitive& primitive)
{
    Box3d box;
    for (const Annotation& line : drawn_primitive(primitive, book.placement_of(primitive), {}))
        for (const Vec3d& p : line.line) box.extend(p);
    return box;
}

}  // namespace

FitTool::FitTool() : ListTool("Fit Primitives"), picks_(std::make_unique<QObject>())
{
    connect(&worker_, &Worker::progressed, this, [this](double fraction, const QString& stage) {
        if (panel_) panel_->show_progress(std::make_pair(stage, fraction));
    });
}

FitTool::~FitTool() { delete panel_; }

PrimitiveBook& FitTool::book() const { return view_->scene().part<PrimitiveBook>(); }

void FitTool::publish(const QString& state)
{
    if (!view_) return;
    view_->widget().setProperty("pcm_fit_tool", QVariantMap{{"state", state}, {"fits", fits_}});
    publish_camera(*view_);
}

bool FitTool::start(SceneView& view)
{
    if (!take_view(view)) return false;
    if (!panel_) make_panel();
    show_dock(view, *panel_);
    connect(&view.scene().part<PrimitiveBook>(), &PrimitiveBook::changed, this, &FitTool::show_panel,
            Qt::UniqueConnection);
    view.widget().installEventFilter(this);
    view.widget().setFocus();
    view.widget().setCursor(Qt::CrossCursor);
    guarded([&] { show_panel(); });
    publish("idle");
    say("click a surface. Enter accepts what is fitted there, Esc discards it");
    return true;
}

void FitTool::end()
{
    wanted_.reset();
    worker_.cancel();
    guarded([&] {
        forget_first();
        discard();
    });
    disconnect(&view_->scene().part<PrimitiveBook>(), nullptr, this, nullptr);
    view_->widget().removeEventFilter(this);
    forget_press();
    view_->scene().part<PrimitiveBook>().select(std::nullopt);
    if (panel_) panel_->hide();
    publish({});
    view_ = nullptr;
}

void FitTool::make_panel()
{
    panel_ = new FitPanel(view_->window());
    connect(panel_, &FitPanel::settings_changed, this, [this] {
        if (!view_ || (!draft_ && !wanted_)) return;
        guarded([&] {
            if (!wanted_) wanted_ = draft_->places;
            fit();
        });
    });
    connect(panel_, &FitPanel::pressed, this, [this](FitPanel::Button button) {
        if (view_) guarded([&] { press(button); });
    });
    connect(panel_, &FitPanel::renamed, this, [this](int index, const QString& text) {
        if (!view_) return;
        guarded([&] {
            book().change(
                [&](PrimitiveList& list) { list.rename(static_cast<std::size_t>(index), text.toStdString()); });
        });
        show_panel();  // a name that was refused is put back
    });
    connect(panel_, &FitPanel::hidden, this, [this](int index, bool hidden) {
        if (view_)
            guarded([&] {
                book().change([&](PrimitiveList& list) { list.hide(static_cast<std::size_t>(index), hidden); });
            });
    });
    connect(panel_, &FitPanel::selected, this, [this](int index) {
        if (view_) book().select(index < 0 ? std::nullopt : std::make_optional(static_cast<std::size_t>(index)));
    });
}

void FitTool::show_panel()
{
    if (!view_ || !panel_) return;
    unit_ = length_unit_of(view_->scene()).symbol;
    panel_->show_list(book().list(), book().selected(), unit_);
    show_draft();
}

void FitTool::click(const QPoint& place, Qt::KeyboardModifiers modifiers)
{
    const Way way = (modifiers & Qt::ControlModifier)                     ? Way::add
                    : (modifiers & (Qt::ShiftModifier | Qt::AltModifier)) ? Way::take_away
                                                                          : Way::first;
    publish("picking");
    pick(*view_, place, *picks_, [this, way](const PickAnswer& answer) {
        if (!view_ || !answer.final) return;
        guarded([&] {
            publish("idle");
            if (!answer.point) {
                ++fits_;
                publish("idle");
                return say(answer.message);
            }
            take(way, *answer.point);
        });
    });
}

void FitTool::take(Way way, const Picked& picked)
{
    const FitPlaces* before = wanted_ ? &*wanted_ : draft_ ? &draft_->places : nullptr;
    if (way == Way::take_away && !before) return say("no shape yet that a place can be removed from: click a surface");
    FitPlaces places;
    if (way != Way::first && before) {
        if (before->layer_id != picked.layer_id)
            return say("that point is of another layer than the shape: a shape is fitted to one cloud");
        places = *before;
    }
    places.layer_id = picked.layer_id;
    places.cloud = picked.cloud;
    (way == Way::take_away ? places.off : places.on).push_back(picked.position);
    wanted_ = std::move(places);
    say({});
    fit();
}

void FitTool::fit()
{
    if (worker_.is_running()) {
        worker_.cancel();
        again_ = true;
        return;
    }
    const SceneLayer* layer = view_->scene().layer(wanted_->layer_id);
    if (!layer) {
        wanted_.reset();
        publish(draft_ ? "draft" : "idle");
        return say("the layer of the clicked cloud was removed");
    }
    FitAtOptions options;
    try {
        options = options_of(panel_->settings());
        options.limit = shown_points(*view_, *layer).selection();
    } catch (...) {
        wanted_.reset();
        throw;
    }
    const auto found = std::make_shared<std::optional<FittedPrimitive>>();
    panel_->show_progress(std::make_pair(QString("Fitting"), 0.0));
    publish("fitting");
    worker_.start(
        [this, number = fits_, places = *wanted_, options, found](const ProgressFunction& progress) {
            FitAtOptions running = options;
            running.progress = running.fit.progress = progress;
            running.found_at_place = [this, number, places](const Primitive& primitive) {
                const auto show = [=] { show_first(number, places, primitive); };
                QMetaObject::invokeMethod(this, show, Qt::QueuedConnection);
            };
            *found = fit_at(*places.cloud, places.on, places.off, running);
        },
        [this, places = *wanted_, found](std::exception_ptr failure) {
            if (panel_) panel_->show_progress(std::nullopt);
            if (view_) guarded([&] { take_fit(places, *found, failure); });
        });
}

void FitTool::show_first(int number, const FitPlaces& places, const Primitive& primitive)
{
    if (!view_ || !wanted_ || again_ || number != fits_) return;
    first_.emplace();
    first_->places = places;
    first_->primitive = primitive;
    guarded([&] { show_draft(); });
    publish("following");
}

void FitTool::forget_first()
{
    if (!first_) return;
    first_.reset();
    show_draft();
}

void FitTool::take_fit(const FitPlaces& places, std::optional<FittedPrimitive>& found, std::exception_ptr failure)
{
    forget_first();
    if (std::exchange(again_, false) && wanted_) return fit();
    const bool cancelled = !wanted_;  // what was found in spite of that is dropped
    wanted_.reset();
    ++fits_;
    publish(draft_ ? "draft" : "idle");
    if (cancelled) return say("cancelled");
    if (failure) std::rethrow_exception(failure);
    const ShapeFit& fit = found->primitive.fit;
    const SceneLayer* layer = view_->scene().layer(places.layer_id);
    const auto tree = layer ? layer->drawn() : std::nullopt;
    if (!tree || tree->cloud != places.cloud) return say("the layer's cloud has changed: click again");
    if (!fit.has_shape())
        return say(
            QString("no %1 was fitted (%2): %3")
                .arg(QString(traits_of(fit.shape.kind).name), name_of(fit.issue), QString::fromStdString(fit.message)));
    keep_draft(places, *found);
}

void FitTool::keep_draft(const FitPlaces& places, FittedPrimitive& found)
{
    SceneLayer& layer = *view_->scene().layer(places.layer_id);
    SceneState& scene = view_->scene().part<SceneState>();
    if (draft_ && draft_->places.layer_id != places.layer_id) discard();
    FitDraft draft;
    draft.before = draft_ ? draft_->before : scene.selection(layer);
    draft.places = places;
    draft.primitive = std::move(found.primitive);
    draft.primitive.cloud = cloud_name(layer);
    draft.reached = std::move(found.reached);
    draft.points = std::make_shared<const PointSet>(std::move(found.points));
    draft_ = std::move(draft);
    scene.select(layer, draft_->points,
                 QString("fitted %1, %2 points")
                     .arg(QString(traits_of(draft_->primitive.fit.shape.kind).name),
                          QString::fromStdString(grouped(draft_->points->size()))));
    show_draft();
    QStringList words;
    if (const auto same = same_shape(book().list(), draft_->primitive))
        words << QString("the same as '%1' of the list: Enter would add it once more")
                     .arg(QString::fromStdString(book().list()[*same].name));
    if (!doubt().isEmpty()) words << doubt();
    for (const std::string& note : found.notes) words << QString::fromStdString(note);
    if (found.rounds > 0 && !found.converged && found.left_surface.empty())
        words << "the shape still changed when it was last fitted to the points that it had reached";
    say(words.join("; "));
    publish("draft");
}

std::vector<Annotation> FitTool::drawn(const FitDraft& draft, const QString& label) const
{
    const SceneLayer* layer = view_->scene().layer(draft.places.layer_id);
    const auto tree = layer ? layer->drawn() : std::nullopt;
    const auto placement = tree ? layer->placement() : std::nullopt;
    std::vector<Annotation> drawn = drawn_primitive(draft.primitive, placement, {draft_colour, true, label});
    for (const bool on : {true, false}) {
        Annotation places;
        for (const Vec3d& p : on ? draft.places.on : draft.places.off)
            places.marks.push_back(placement ? (*placement)(p) : p);
        places.colour = on ? draft_colour : QColor(255, 80, 60);
        places.on_top = true;
        drawn.push_back(places);
    }
    return drawn;
}

void FitTool::show_draft()
{
    const FitDraft* const shown = first_ ? &*first_ : draft_ ? &*draft_ : nullptr;
    std::vector<Annotation> marks;
    QString text;
    if (shown) {
        const Primitive& primitive = shown->primitive;
        const QString label = traits_of(primitive.fit.shape.kind).label, size = size_of(primitive, unit_);
        const QString points = QString::fromStdString(grouped(primitive.points));
        marks = drawn(*shown, label + "\n" + size);
        text = label + ": " + size + "\n";
        if (first_)
            text += "of the " + points + " points around the place. It is followed through the cloud; Esc cancels it.";
        else
            text += QString("residual %1, %2 points, %3%4. %5")
                        .arg(QString::fromStdString(brief(primitive.fit.rms) + (unit_.empty() ? "" : " " + unit_)),
                             points, counted(draft_->places.on.size(), "place"),
                             draft_->places.off.empty()
                                 ? QString()
                                 : ", " + counted(draft_->places.off.size(), "place") + " taken away",
                             doubt().isEmpty()     ? "Enter accepts it."
                             : draft_->doubt_shown ? "Doubtful: Enter again accepts it."
                                                   : "Doubtful: Enter says why, and Enter again accepts it.");
    }
    view_->scene().part<Annotations>().set(draft_owner, std::move(marks));
    if (panel_) panel_->show_found(text, draft_ && !first_);
}

QString FitTool::doubt() const
{
    if (!draft_ || draft_->primitive.fit.verdict != FitVerdict::doubtful) return {};
    const ShapeFit& fit = draft_->primitive.fit;
    return QString("doubtful (%1): %2").arg(name_of(fit.issue), QString::fromStdString(fit.message));
}

void FitTool::accept()
{
    if (!draft_) return say("there is nothing to accept: click a surface");
    if (wanted_) throw Error(ErrorCode::invalid_argument, {}, "the shape is being fitted", "wait until it is done");
    if (!doubt().isEmpty() && !std::exchange(draft_->doubt_shown, true)) {
        show_draft();
        return say("not accepted yet: it is " + doubt() + ". Enter again accepts it, Esc discards it");
    }
    Primitive primitive = std::move(draft_->primitive);
    primitive.colour = next_colour(book().list());
    const auto points = draft_->points;
    const ReachedFrom reached = std::move(draft_->reached);
    draft_.reset();  // its points stay selected
    std::size_t index = 0;
    book().change([&](PrimitiveList& list) { index = list.add(std::move(primitive)); });
    book().keep_points(book().list()[index], points, reached);
    book().select(index);
    show_draft();
    publish("idle");
    say(QString("%1: %2").arg(QString::fromStdString(book().list()[index].name), size_of(book().list()[index], unit_)));
}

bool FitTool::cancel()
{
    if (wanted_ || worker_.is_running()) {
        again_ = false;
        wanted_.reset();
        worker_.cancel();
        return true;
    }
    if (!draft_) return false;
    discard();
    say("discarded");
    return true;
}

bool FitTool::take_back()
{
    if (!draft_ || wanted_) return false;
    FitPlaces places = draft_->places;
    if (!places.off.empty())
        places.off.pop_back();
    else if (places.on.size() > 1)
        places.on.pop_back();
    else
        return false;
    wanted_ = std::move(places);
    fit();
    return true;
}

void FitTool::discard()
{
    if (!draft_) return;
    const FitDraft draft = std::move(*draft_);
    draft_.reset();
    if (const SceneLayer* layer = view_->scene().layer(draft.places.layer_id)) {
        SceneState& scene = view_->scene().part<SceneState>();
        if (scene.selection(*layer) == draft.points) scene.select(*layer, draft.before, "fitted shape discarded");
    }
    show_draft();
    publish("idle");
}

void FitTool::press(FitPanel::Button button)
{
    using Button = FitPanel::Button;
    const auto selected = book().selected();
    say({});
    switch (button) {
        case Button::accept:
            return accept();
        case Button::discard:
            cancel();
            return;
        case Button::look_at:
            if (selected) look_at(*view_, box_in_scene(book(), book().list()[*selected]), filled_by_primitive);
            return;
        case Button::colour:
            if (selected) choose_colour(*selected);
            return;
        case Button::remove:
            if (selected) book().change([&](PrimitiveList& list) { list.remove(*selected); });
            return;
        case Button::clear:
            return book().change([](PrimitiveList& list) { list.clear(); });
        case Button::undo:
            return book().change([](PrimitiveList& list) { list.undo(); });
        case Button::redo:
            return book().change([](PrimitiveList& list) { list.redo(); });
        case Button::copy:
            if (book().list().empty()) return say("nothing to copy: the list is empty");
            copy(selected);
            return say("copied");
        case Button::save:
            return write();
        case Button::defaults:
            return panel_->show_defaults();
        default:
            return use_points(button);
    }
}

}  // namespace pcm::host
