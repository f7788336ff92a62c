// What the tool Fit Primitives does with primitives of the list: files, colours, their points.
#include "pcm/cad/dxf_file.h"
#include "pcm/cad/primitive_files.h"
#include "pcm/place/grow_shape.h"
#include "pcm/place/reached_from.h"
#include "pcm/shapes/shape_lines.h"
#include "pcm/system/error.h"
#include "plugin/panels/ask_unit.h"
#include "plugin/scene/drawn_primitives.h"
#include "plugin/scene/length_unit.h"
#include "plugin/scene/measure_book.h"
#include "plugin/scene/primitive_book.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/text.h"
#include "plugin/tools/fit/fit_tool.h"

#include <QClipboard>
#include <QColorDialog>
#include <QFileDialog>
#include <QFileInfo>
#include <QGuiApplication>

#include <utility>

namespace pcm::host {

namespace {

constexpr double any_normal = 4;  // radians: normals are not compared

CadUnit unit_of(const std::string& symbol)
{
    return symbol == "m" ? CadUnit::metres : symbol == "ft" || symbol == "ftUS" ? CadUnit::feet : CadUnit::none;
}

// The points near the surface, in the primitive's box.
Selection around(const Primitive& primitive)
{
    Box3d box = box_of(primitive.fit.shape, primitive.bounds);
    for (std::size_t a = 0; a < 3; ++a) {
        box.min[a] -= primitive.fit.threshold;
        box.max[a] += primitive.fit.threshold;
    }
    Selection selection;
    if (!box.empty()) selection.box = box;
    return selection;
}

// Those that were reached when it was fitted; all near the surface where that is not known, as of shapes that were
// detected, or where the cloud has none of them any more.
PointSet points_again(const std::shared_ptr<const Tree>& tree, const Primitive& primitive,
                      const std::optional<ReachedFrom>& reached, const ProgressFunction& progress)
{
    if (reached) {
        ReachOptions options;
        options.progress = progress;
        PointSet points = reach_again(tree, *reached, options);
        if (!points.empty()) return points;
    }
    return points_on_shape(tree, primitive.fit.shape, primitive.fit.threshold, any_normal, around(primitive), 0,
                           progress);
}

}  // namespace

void FitTool::write()
{
    const QString filter =
        QString(writes_dxf() ? "Drawing (*.dxf);;" : "") + (writes_step() ? "Solids, STEP (*.step *.stp);;" : "") +
        "Building model, IFC (*.ifc);;AutoCAD script (*.scr);;Comma-separated values (*.csv);;List (*.json)";
    QString kind;
    QString file =
        QFileDialog::getSaveFileName(panel_, "Export primitives", writes_dxf() ? "primitives.dxf" : "primitives.scr",
                                     filter, &kind, QFileDialog::DontUseNativeDialog);
    if (file.isEmpty()) return;
    CadOptions options;
    // The dialog asks before it replaces the file that was typed, and no other.
    options.overwrite = !QFileInfo(file).suffix().isEmpty();
    if (!options.overwrite) file += kind.mid(kind.indexOf("*.") + 1).remove(')');
    LengthUnit unit = length_unit_of(view_->scene());
    // The only one of the files that says what its numbers are.
    if (!unit.is_stated && QFileInfo(file).suffix().toLower() == "dxf") {
        const QPointer<SceneView> alive(view_);
        const auto said = ask_unit(view_->scene(), panel_);
        if (!said || !alive || !view_) return;
        unit.symbol = *said;
        view_->scene().part<MeasureBook>().refresh_unit();
        show_panel();
    }
    options.unit = unit_of(unit.symbol);
    const bool everything = QFileInfo(file).suffix().toLower() == "json";  // hidden ones too
    const CadReport report = write_primitives(file.toStdString(), book().placed(everything), options);
    QStringList words{QString("wrote %1 primitives to %2").arg(report.written).arg(file)};
    if (report.runs > 0) words << QString("%1 pipe runs of them in addition").arg(report.runs);
    for (const std::string& note : report.notes) words << QString::fromStdString(note);
    bool moved = false;
    for (std::size_t i = 0; i < book().list().size(); ++i)
        moved = moved || book().placement_of(book().list()[i]).has_value();
    if (moved) words << "moved as the matrices of their layers move the clouds";
    say(words.join("; "));
}

void FitTool::copy(std::optional<std::size_t> index) const
{
    QString text;
    for (std::size_t i = 0; i < book().list().size(); ++i) {
        if (index && *index != i) continue;
        const Primitive& primitive = book().list()[i];
        text += QString::fromStdString(primitive.name) + "\n";
        for (const auto& [name, value] : lines_of(book().list(), i, unit_))
            text += "  " + name + ": " + QString(value).replace('\n', ' ') + "\n";
    }
    QGuiApplication::clipboard()->setText(text);
}

void FitTool::choose_colour(std::size_t index)
{
    const QColor chosen = QColorDialog::getColor(colour_of(book().list()[index]), panel_, "Colour of the primitive",
                                                 QColorDialog::DontUseNativeDialog);
    if (!chosen.isValid() || index >= book().list().size()) return;
    Primitive primitive = book().list()[index];
    primitive.colour = {static_cast<std::uint8_t>(chosen.red()), static_cast<std::uint8_t>(chosen.green()),
                        static_cast<std::uint8_t>(chosen.blue())};
    book().change([&](PrimitiveList& list) { list.replace(index, primitive); });
}

// Selects the primitive's points, which are found first where they are not known.
void FitTool::with_points(std::size_t index, const std::function<void(SceneLayer& layer)>& then)
{
    const Primitive primitive = book().list()[index];
    SceneLayer* const layer = book().layer_of(primitive);
    const auto tree = layer ? layer->drawn() : std::nullopt;
    if (!tree)
        throw Error(ErrorCode::invalid_argument, {}, "no layer shows the cloud of " + primitive.name,
                    "open " + primitive.cloud);
    const auto select = [this, primitive, then, id = layer->id()](const std::shared_ptr<const PointSet>& points) {
        SceneLayer* const shown = view_->scene().layer(id);
        if (!shown) return;
        if (points->empty()) return say("no points on " + QString::fromStdString(primitive.name));
        view_->scene().part<SceneState>().select(
            *shown, points,
            QString("%1, %2 points")
                .arg(QString::fromStdString(primitive.name), QString::fromStdString(grouped(points->size()))));
        say(QString("%1: %2 points selected")
                .arg(QString::fromStdString(primitive.name), QString::fromStdString(grouped(points->size()))));
        if (then) then(*shown);
    };
    if (const auto points = book().points_of(primitive)) return select(points);
    if (worker_.is_running())
        throw Error(ErrorCode::invalid_argument, {}, "a shape is being fitted", "wait until it is done, or press Esc");
    const auto found = std::make_shared<std::shared_ptr<const PointSet>>();
    const ReachedFrom* const known = book().reached(primitive);
    const auto reached = known ? std::make_optional(*known) : std::nullopt;
    panel_->show_progress(std::make_pair(QString("Finding points"), 0.0));
    worker_.start(
        [primitive, reached, found, shared = tree->cloud->tree()](const ProgressFunction& progress) {
            *found = std::make_shared<const PointSet>(points_again(shared, primitive, reached, progress));
        },
        [this, primitive, found, select](std::exception_ptr failure) {
            if (panel_) panel_->show_progress(std::nullopt);
            if (!view_) return;
            guarded([&] {
                if (std::exchange(again_, false) && wanted_) return fit();  // a click has ended it
                if (failure) std::rethrow_exception(failure);
                book().keep_points(primitive, *found);
                select(*found);
            });
        });
}

void FitTool::use_points(FitPanel::Button button)
{
    using Button = FitPanel::Button;
    const auto selected = book().selected();
    if (!selected) return say("select a primitive of the list first");
    if (draft_) discard();
    if (button == Button::select_points) return with_points(*selected, {});
    const SelectionUse use = button == Button::to_layer        ? SelectionUse::to_layer
                             : button == Button::to_file       ? SelectionUse::to_file
                             : button == Button::remove_points ? SelectionUse::remove
                                                               : SelectionUse::save;
    with_points(*selected, [this, use](SceneLayer& layer) {
        const QPointer<SceneView> alive(view_);
        const QString done = use_selected(*view_, layer, use);
        if (alive && view_ && !done.isEmpty()) say(done);
    });
}

}  // namespace pcm::host
