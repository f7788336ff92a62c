// Profiles and volumes of the tool Measure: what needs a pass over clouds.
#include "pcm/cloud/vector.h"
#include "pcm/measure/volume.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "plugin/scene/measure_book.h"
#include "plugin/scene/scene_view.h"
#include "plugin/scene/shown_points.h"
#include "plugin/tools/measure/default_width.h"
#include "plugin/tools/measure/measure_tool.h"
#include "plugin/tools/measure/profile_window.h"
#include "plugin/tools/view_camera.h"

#include <QFileDialog>
#include <QFileInfo>
#include <QPointer>

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

constexpr std::size_t most_plotted = 2'000'000;  // about 100 MB, and half a second to draw

LayerCloud drawn_tree(const SceneLayer& layer)
{
    auto tree = layer.drawn();
    if (tree) return *std::move(tree);
    throw Error(ErrorCode::invalid_argument, {},
                "the layer '" + layer.label().toStdString() + "' shows no point cloud");
}

std::vector<Vec3d> positions_of(const Measure& measure)
{
    std::vector<Vec3d> positions;
    for (const MeasuredPoint& point : measure.points) positions.push_back(point.position);
    return positions;
}

}  // namespace

SceneLayer& MeasureTool::layer_of(const Measure& measure) const
{
    Scene& scene = view_->scene();
    const auto shows_a_cloud = [](SceneLayer* layer) { return layer && layer->drawn(); };
    for (const std::optional<int>& id : {panel_->cloud(), first_layer_})
        if (SceneLayer* layer = id ? scene.layer(*id) : nullptr; shows_a_cloud(layer)) return *layer;
    for (SceneLayer* layer : scene.layers()) {
        const auto tree = layer ? layer->drawn() : std::nullopt;
        if (tree && !measure.points.empty() && tree->cloud->tree()->folder() == measure.points.front().cloud)
            return *layer;
    }
    if (shows_a_cloud(scene.current())) return *scene.current();
    throw Error(ErrorCode::invalid_argument, {}, "no layer shows the cloud that '" + measure.name + "' is measured in",
                "Choose one as Cloud.");
}

double MeasureTool::width_for(const Measure& measure) const
{
    if (const auto typed = panel_->width()) return *typed;
    if (const double usual = usual_width(measure.points); usual > 0) return usual;
    throw Error(ErrorCode::invalid_argument, {}, "the distance between the points at the line is not known",
                "Type a width.");
}

double MeasureTool::usual_width(const std::vector<MeasuredPoint>& line) const
{
    ProfileLine known;
    known.spacings = spacings_;
    const auto map = map_of(*view_);
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (map) known.pixel = std::max(known.pixel, map->pixel_size(line[i].position));
        if (i == 0) continue;
        const Vec3d step = line[i].position - line[i - 1].position;
        known.length += std::hypot(step[0], step[1]);
    }
    return default_width(known);
}

void MeasureTool::measure_cloud(std::size_t index)
{
    const Measure& measure = book().list()[index];
    if (measure.kind == MeasureKind::profile) return plot(measure);
    if (measure.kind == MeasureKind::volume) return find_volume(measure);
}

void MeasureTool::plot(const Measure& measure)
{
    SceneLayer& layer = layer_of(measure);
    auto data = std::make_shared<ProfileData>();
    const LayerCloud tree = drawn_tree(layer);
    data->cloud = tree.cloud;
    data->options.placement = layer.placement();
    data->options.line = positions_of(measure);
    data->options.width = measure.width;
    const Query shown = shown_points(*view_, layer);
    data->options.where = shown.where;
    data->options.clips = shown.clips;
    data->title = QString::fromStdString(measure.name);
    data->unit = QString::fromStdString(book().unit().symbol);
    begin("Profile", [this, data](const ProgressFunction& progress) -> Afterwards {
        read_profile(*data, most_plotted, progress);
        return [this, data] {
            if (!view_) return;
            auto* window = new ProfileWindow(panel_, data);
            connect(window, &ProfileWindow::wanted, this, [this, data, window](const QString& extension) {
                guarded([&] { write_points(data, extension, *window); });
            });
            window->show();
            say(data->title + ": " + data->words);
        };
    });
}

void MeasureTool::write_points(const std::shared_ptr<const ProfileData>& data, const QString& extension,
                               ProfileWindow& window)
{
    const QString filter = extension == "csv" ? "Comma-separated values (*.csv)" : "Drawing (*.dxf)";
    QString file = QFileDialog::getSaveFileName(&window, "Write the points of the profile", "profile." + extension,
                                                filter, nullptr, QFileDialog::DontUseNativeDialog);
    if (file.isEmpty()) return;
    // The dialog has asked about the file that was typed alone.
    const bool typed = !QFileInfo(file).suffix().isEmpty();
    if (!typed) file += "." + extension;
    begin("Writing",
          [this, data, file, typed,
           shown = QPointer<ProfileWindow>(&window)](const ProgressFunction& progress) -> Afterwards {
              ProfileOptions options = data->options;
              options.progress = progress;
              for (const Attribute& attribute : data->cloud->info().schema)
                  options.attributes.push_back(attribute.name);
              ProfileFileOptions file_options;
              file_options.overwrite = typed;
              const Outcome outcome = write_profile(*data->cloud, options, file.toStdString(), file_options);
              return [this, outcome, file, shown, moved = options.placement.has_value()] {
                  const QString words = QString("wrote %1 points to %2%3")
                                            .arg(QString::fromStdString(grouped(outcome.points_out)), file,
                                                 moved ? ", moved by the layer's matrix" : "");
                  say(words);
                  if (shown) shown->say(words);
              };
          });
}

void MeasureTool::find_volume(const Measure& measure)
{
    SceneLayer& layer = layer_of(measure);
    const LayerCloud tree = drawn_tree(layer);
    VolumeOptions options;
    options.placement = layer.placement();
    options.polygon = positions_of(measure);
    const Query shown = shown_points(*view_, layer);
    options.where = shown.where;
    options.clips = shown.clips;
    double level = measure.points.front().position[2];
    for (const MeasuredPoint& point : measure.points) level = std::min(level, point.position[2]);
    level = panel_->level().value_or(level);
    const auto compared = panel_->compared_cloud();
    if (compared) {
        SceneLayer* const other = view_->scene().layer(*compared);
        if (!other) throw Error(ErrorCode::invalid_argument, {}, "the layer to compare with is no longer there");
        const LayerCloud before = drawn_tree(*other);
        options.before = before.cloud;
        options.placement_before = other->placement();
        options.limits_before = shown_points(*view_, *other).selection();
    } else {
        options.reference.height = level;
    }
    options.side = panel_->cell().value_or(0);
    begin("Volume", [this, cloud = tree.cloud, options, measure, level, compared](const ProgressFunction& progress) {
        VolumeOptions running = options;
        running.progress = progress;
        const VolumeReport report = measure_volume(*cloud, running);
        std::vector<MeasureValue> values = report.values();
        if (!compared) values.push_back({"level", level, 0, ""});
        return Afterwards([this, measure, values, notes = report.notes()] { take_volume(measure, values, notes); });
    });
}

void MeasureTool::take_volume(const Measure& measure, const std::vector<MeasureValue>& values,
                              const std::vector<std::string>& notes)
{
    if (!view_) return;
    const MeasureList& list = book().list();
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (list[i].kind != measure.kind || list[i].points.size() != measure.points.size() ||
            list[i].points.front().position != measure.points.front().position || list[i].name != measure.name)
            continue;
        Measure found = list[i];
        found.computed = values;
        book().change([&](MeasureList& changed) { changed.replace(i, found); });
        book().select(i);
        std::string words = found.name + ": " + label_of(found, book().unit().symbol);
        for (const std::string& note : notes) words += "; " + note;
        return say(QString::fromStdString(words));
    }
    say("the volume's measure has been deleted");
}

void MeasureTool::begin(const QString& what, const std::function<Afterwards(const ProgressFunction& progress)>& work)
{
    const auto afterwards = std::make_shared<Afterwards>();
    work_.start([work, afterwards](const ProgressFunction& progress) { *afterwards = work(progress); },
                [this, afterwards](std::exception_ptr failure) {
                    if (panel_) panel_->show_progress(std::nullopt);
                    if (work_.is_cancelled()) return;  // what was found in spite of that is dropped
                    guarded([&] {
                        if (failure) std::rethrow_exception(failure);
                        (*afterwards)();
                    });
                });
    panel_->show_progress(std::make_pair(what, 0.0));
}

}  // namespace pcm::host
