#include "plugin/tools/measure/measure_tool.h"

#include "pcm/cad/dxf_file.h"
#include "pcm/cloud/vector.h"
#include "pcm/measure/measure_export.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "plugin/panels/tool_dock.h"
#include "plugin/scene/annotations.h"
#include "plugin/scene/drawn_measures.h"
#include "plugin/scene/measure_book.h"
#include "plugin/scene/measure_text.h"
#include "plugin/scene/project_unit.h"
#include "plugin/scene/text.h"
#include "plugin/tools/measure/look_at.h"
#include "plugin/tools/view_camera.h"

#include <QClipboard>
#include <QFileDialog>
#include <QFileInfo>
#include <QGuiApplication>
#include <QMainWindow>
#include <QMouseEvent>

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

const char* const draft_owner = "measure draft";

// The point in the coordinates of the scene.
MeasuredPoint measured(const Picked& picked, const Scene& scene)
{
    MeasuredPoint point{picked.shown_at, picked.spacing, picked.grid_step, {}};
    if (picked.cloud) point.cloud = picked.cloud->tree()->folder().string();
    SceneLayer* const layer = const_cast<Scene&>(scene).layer(picked.layer_id);
    const auto tree = layer ? layer->drawn() : std::nullopt;
    if (tree && tree->is_copy()) point.cloud.clear();  // a temporary tree
    const auto placement = tree ? layer->placement() : std::nullopt;
    if (!placement) return point;
    const double scale = std::cbrt(std::abs(placement->determinant()));
    point.spacing *= scale;
    point.grid_step *= scale;
    return point;
}

// What the points that are known give already.
QString so_far(const Draft& draft, const std::string& unit)
{
    Measure measure;
    measure.kind = draft.kind();
    measure.points = draft.points();
    if (measure.points.empty()) return {};
    const QString count = "\n" + QString::fromStdString(points_text(measure.points.size()));
    try {
        return count + ": " + QString::fromStdString(text_of(values_of(measure).at(0), unit));
    } catch (...) {  // too few points, or such that more are needed
        return count;
    }
}

}  // namespace

MeasureTool::MeasureTool() : ListTool("Measure"), picks_(std::make_unique<QObject>())
{
    connect(&work_, &Worker::progressed, this, [this](double fraction, const QString& stage) {
        if (panel_) panel_->show_progress(std::make_pair(stage, fraction));
    });
}

MeasureTool::~MeasureTool() { delete panel_; }

MeasureBook& MeasureTool::book() const { return view_->scene().part<MeasureBook>(); }

bool MeasureTool::start(SceneView& view)
{
    if (!take_view(view)) return false;
    if (!panel_) make_panel();
    show_dock(view, *panel_);
    connect(&view.scene().part<MeasureBook>(), &MeasureBook::changed, this, &MeasureTool::show_panel,
            Qt::UniqueConnection);
    tracked_mouse_ = view.widget().hasMouseTracking();
    view.widget().setMouseTracking(true);
    view.widget().installEventFilter(this);
    view.widget().setFocus();
    view.widget().setCursor(Qt::CrossCursor);
    guarded([&] {
        book().refresh_unit();
        change_kind();
        show_panel();
    });
    say("click points in the view; Backspace takes the last one back, Enter, a double click or the right button ends a "
        "line or polygon, Esc cancels it, Ctrl+Z takes a change of the list back. Dragging and the wheel move the "
        "camera");
    if (!book().unit().warning.isEmpty()) say(book().unit().warning);
    return true;
}

void MeasureTool::end()
{
    stop();
    disconnect(&view_->scene().part<MeasureBook>(), nullptr, this, nullptr);
    view_->widget().removeEventFilter(this);
    view_->widget().setMouseTracking(tracked_mouse_);
    forget_press();
    view_->scene().part<MeasureBook>().select(std::nullopt);
    if (panel_) panel_->hide();
    view_ = nullptr;
}

void MeasureTool::make_panel()
{
    panel_ = new MeasurePanel(view_->window());
    connect(panel_, &MeasurePanel::kind_chosen, this, [this] {
        if (view_) guarded([&] { change_kind(); });
    });
    connect(panel_, &MeasurePanel::unit_chosen, this, [this](const QString& symbol) {
        if (!view_) return;
        guarded([&] {
            choose_unit(view_->scene(), symbol.toStdString());
            book().refresh_unit();
        });
    });
    connect(panel_, &MeasurePanel::pressed, this, [this](MeasurePanel::Button button) {
        if (view_) guarded([&] { press(button); });
    });
    connect(panel_, &MeasurePanel::renamed, this, [this](int index, const QString& text) {
        if (!view_) return;
        guarded([&] {
            book().change([&](MeasureList& list) { list.rename(static_cast<std::size_t>(index), text.toStdString()); });
        });
        show_panel();  // a name that was refused is put back
    });
    connect(panel_, &MeasurePanel::hidden, this, [this](int index, bool hidden) {
        if (view_)
            guarded(
                [&] { book().change([&](MeasureList& list) { list.hide(static_cast<std::size_t>(index), hidden); }); });
    });
    connect(panel_, &MeasurePanel::selected, this, [this](int index) {
        if (view_) book().select(index < 0 ? std::nullopt : std::make_optional(static_cast<std::size_t>(index)));
    });
}

void MeasureTool::show_panel()
{
    if (!view_ || !panel_) return;
    panel_->show_list(book().list(), book().selected(), book().unit().symbol);
    panel_->show_unit(book().unit());
    std::vector<MeasurePanel::Cloud> clouds;
    for (const SceneLayer* layer : view_->scene().layers())
        if (layer->drawn()) clouds.push_back({layer->id(), layer->label()});
    panel_->show_clouds(clouds);
}

void MeasureTool::change_kind()
{
    stop();
    draft_ = Draft(panel_->kind());
    panel_->show_hint(hint_of(draft_.kind()));
    view_->widget().setFocus();
}

void MeasureTool::show_draft()
{
    const auto points = draft_.points();
    std::vector<Annotation> drawn;
    if (!points.empty()) drawn.push_back(drawn_draft(draft_.kind(), points));
    view_->scene().part<Annotations>().set(draft_owner, std::move(drawn));
    if (!panel_) return;
    panel_->show_hint(hint_of(draft_.kind()) + so_far(draft_, book().unit().symbol));
    if (points.empty()) return;
    const std::string cell = brief(4 * points.front().spacing);
    const double width = usual_width(points);
    panel_->propose_width(points.size() > 1 && width > 0 ? QString::fromStdString(exact(width)) : QString());
    panel_->propose_cell(points.front().spacing > 0 ? QString::fromStdString(cell) : QString());
}

void MeasureTool::click(const QPoint& place, Qt::KeyboardModifiers)
{
    const auto number = draft_.click();
    if (!number) return say("the measure is not complete yet: a click has not been answered");
    say({});
    // Each click has a context of its own, so that the next one does not replace it.
    auto* context = new QObject(picks_.get());
    pick(*view_, place, *context, [this, context, number = *number](const PickAnswer& answer) {
        if (answer.final) context->deleteLater();
        if (view_) guarded([&] { take(number, answer); });
    });
}

void MeasureTool::take(int click, const PickAnswer& answer)
{
    if (answer.point) {
        draft_.answer(click, measured(*answer.point, view_->scene()), answer.final);
        if (!first_layer_) first_layer_ = answer.point->layer_id;
        if (answer.final) spacings_.push_back(answer.point->spacing_around * answer.point->scale);
    } else if (answer.final) {
        draft_.miss(click);
        say(answer.message);
    }
    show_draft();
    finish();
}

void MeasureTool::end_draft()
{
    if (draft_.empty()) return;
    const QString refusal = draft_.end();
    if (!refusal.isEmpty()) return say(refusal);
    finish();
}

bool MeasureTool::cancel()
{
    const bool did = stop();
    if (did) say("cancelled");
    return did;
}

bool MeasureTool::stop()
{
    const bool did = !draft_.empty() || work_.is_running();
    work_.cancel();
    picks_ = std::make_unique<QObject>();
    clear_draft();
    return did;
}

void MeasureTool::clear_draft()
{
    draft_.clear();
    first_layer_.reset();
    spacings_.clear();
    if (view_) show_draft();
}

bool MeasureTool::take_back()
{
    if (!draft_.take_back()) return false;
    show_draft();
    return true;
}

void MeasureTool::finish()
{
    if (!draft_.complete()) return;
    Measure measure;
    measure.kind = draft_.kind();
    measure.points = draft_.points();
    try {
        if (measure.kind == MeasureKind::profile) measure.width = width_for(measure);
        values_of(measure);  // refuses points that determine nothing
    } catch (...) {
        draft_.reopen();
        show_draft();
        throw;
    }
    const auto layer = first_layer_;
    clear_draft();
    keep(std::move(measure));
    first_layer_ = layer;
    measure_cloud(book().list().size() - 1);
    first_layer_.reset();
}

void MeasureTool::keep(Measure measure)
{
    std::size_t index = 0;
    book().change([&](MeasureList& list) { index = list.add(std::move(measure)); });
    book().select(index);
    const Measure& kept = book().list()[index];
    say(QString::fromStdString(kept.name) + ": " + value_of(kept, book().unit().symbol));
}

void MeasureTool::write()
{
    const QString filter = QString("Comma-separated values (*.csv);;GeoJSON (*.geojson);;") +
                           (writes_dxf() ? "Drawing (*.dxf);;" : "") + "List of measures (*.json)";
    QString kind;
    QString file = QFileDialog::getSaveFileName(panel_, "Export measures", "measures.csv", filter, &kind,
                                                QFileDialog::DontUseNativeDialog);
    if (file.isEmpty()) return;
    MeasureFileOptions options;
    options.system = book().unit().system;
    // The dialog asks before it replaces the file that was typed, and no other.
    options.overwrite = !QFileInfo(file).suffix().isEmpty();
    if (!options.overwrite) file += kind.mid(kind.indexOf("*.") + 1).remove(')');
    write_measures(book().list(), file.toStdString(), options);
    say(QString("wrote %1 measures to %2").arg(book().list().size()).arg(file));
}

void MeasureTool::press(MeasurePanel::Button button)
{
    using Button = MeasurePanel::Button;
    const auto selected = book().selected();
    say({});
    switch (button) {
        case Button::end:
            return end_draft();
        case Button::cancel:
            stop();
            return;
        case Button::look_at:
            if (selected) look_at(*view_, book().list()[*selected].points);
            return;
        case Button::remove:
            if (selected) book().change([&](MeasureList& list) { list.remove(*selected); });
            return;
        case Button::clear:
            return book().change([](MeasureList& list) { list.clear(); });
        case Button::undo:
            return book().change([](MeasureList& list) { list.undo(); });
        case Button::redo:
            return book().change([](MeasureList& list) { list.redo(); });
        case Button::copy: {
            QString text;
            for (std::size_t i = 0; i < book().list().size(); ++i)
                if (!selected || *selected == i) text += text_of(book().list()[i], book().unit().symbol);
            QGuiApplication::clipboard()->setText(text);
            return say("copied");
        }
        case Button::save:
            return write();
        case Button::plot:
            if (selected) measure_cloud(*selected);
            return;
        case Button::defaults:
            return panel_->show_defaults();
    }
}

}  // namespace pcm::host
