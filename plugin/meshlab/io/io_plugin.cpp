#include "plugin/meshlab/io/io_plugin.h"

#include "pcm/io/formats.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/system/tree_folder.h"
#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/drawn_copy.h"
#include "plugin/meshlab/io/export.h"
#include "plugin/meshlab/io/export_dialog.h"
#include "plugin/meshlab/io/formats.h"
#include "plugin/meshlab/io/import.h"
#include "plugin/meshlab/layer.h"
#include "plugin/meshlab/native_drawing.h"
#include "plugin/meshlab/registry.h"
#include "plugin/meshlab/rich_parameters.h"
#include "plugin/meshlab/stock.h"
#include "plugin/panels/cancelled.h"
#include "plugin/panels/field_buttons.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

#include <QDir>
#include <QFileInfo>
#include <QTimer>

#include <algorithm>

using namespace pcm;
using namespace pcm::host;

namespace {

// MeshLab passes a bare name and has changed the working folder to the file's.
std::filesystem::path absolute_path(const QString& file_name)
{
    return QDir::cleanPath(QFileInfo(file_name).absoluteFilePath()).toStdString();
}

int mask_of(const MeshModel& layer)
{
    namespace io = vcg::tri::io;
    int mask = io::Mask::IOM_VERTCOORD;
    const auto source = Registry::instance().source_of(layer);
    if (source && source->has(AttributePlace::Kind::normal)) mask |= io::Mask::IOM_VERTNORMAL;
    if (layer.hasDataMask(MeshModel::MM_VERTCOLOR)) mask |= io::Mask::IOM_VERTCOLOR;
    if (layer.hasDataMask(MeshModel::MM_VERTQUALITY)) mask |= io::Mask::IOM_VERTQUALITY;
    if (layer.hasDataMask(MeshModel::MM_VERTRADIUS)) mask |= io::Mask::IOM_VERTRADIUS;
    return mask;
}

FormatList formats_of(const std::vector<FileType>& types)
{
    FormatList list;
    for (const FileType& type : types) list.push_back(FileFormat(type.label, type.extension));
    return list;
}

// The window that shows the layer; null: there is none.
QWidget* window_with(const MeshModel& layer)
{
    const std::vector<GLArea*> views = views_of(document_of(layer));
    return views.empty() ? nullptr : window_of(*views.front());
}

// MeshLab's settings. Without a window there is no dialog, and scripts may give all parameters.
Parameters import_defaults()
{
    for (QWidget* widget : QApplication::allWidgets())
        if (widget->inherits("GLArea")) return parameters_of(*static_cast<GLArea*>(widget)->glas.currentGlobalParamSet);
    Parameters defaults;
    add_global_settings(defaults);
    ask_always(defaults);
    return defaults;
}

bool has_window()
{
    const QWidgetList widgets = QApplication::allWidgets();
    return std::any_of(widgets.begin(), widgets.end(), [](const QWidget* w) { return w->inherits("GLArea"); });
}

// Most errors of the core name their path; it is added to the others.
std::string error_about(const std::filesystem::path& path)
{
    const std::string error = current_error();
    return error.find(path.string()) == std::string::npos ? path.string() + ": " + error : error;
}

}  // namespace

PointCloudIo::PointCloudIo()
{
    refuse_second(PointCloudIo::pluginName());
    connect(&Registry::instance(), &Registry::attached, this, [](const MeshDocument* document) {
        for (const SceneView* view : scene_of(*document).views()) ExportDialog::take_over(*view);
    });
}

FormatList PointCloudIo::all_import_formats() const { return formats_of(import_formats()); }

void PointCloudIo::add_global_parameters(RichParameterList& parameters)
{
    Parameters defaults;
    add_global_settings(defaults);
    add_to(parameters, defaults);
}

RichParameterList PointCloudIo::parameters_before_open(const QString& format, const QString& file_name) const
{
    RichParameterList parameters;
    const bool is_tree = format.compare(tree_extension, Qt::CaseInsensitive) == 0;
    if (file_name.isEmpty()) {
        Parameters asked;
        const std::filesystem::path any = "no-folder/any." + format.toLower().toStdString();
        if (!is_tree) add_file_settings(asked, any, import_defaults());
        add_to(parameters, asked);
        return parameters;
    }
    const std::filesystem::path path = absolute_path(file_name);
    if (is_tree || is_file_of_tree(path)) return parameters;
    if (is_point_cloud(path)) {
        Parameters asked;
        if (has_window()) add_file_settings(asked, path, import_defaults());
        add_to(parameters, asked);
    } else if (auto* stock = stock_importer(format, this)) {
        parameters = stock_open_parameters(*stock, format, file_name);
    }
    add_field_buttons(parameters_of(parameters), nullptr);
    return parameters;
}

void PointCloudIo::opened(MeshModel& layer)
{
    // MeshLab has just decided how to draw the layer.
    const auto source = Registry::instance().source_of(layer);
    if (source && !source->has(AttributePlace::Kind::normal)) draw_unshaded(layer);
}

void PointCloudIo::open_layer(const QString& format, const QString& file_name, MeshModel& layer, int& mask,
                              const RichParameterList& parameters, vcg::CallBackPos* callback)
{
    const std::filesystem::path path = absolute_path(file_name);
    QWidget* const window = window_with(layer);
    try {
        Operation::refuse_second();
        clear_layer(layer);
        if (!is_point_cloud(path))
            if (auto* stock = stock_importer(format, this)) {
                warn_after(stock_open(*stock, {format, file_name, parameters, callback, window}, layer, mask));
                return warn_of_origin(layer,
                                      "This mesh is shown at its own coordinates, but the clouds of this project "
                                      "relative to the origin ",
                                      ".", window);
            }
        ImportSettings settings = read_import_settings(parameters_of(parameters));
        settings.may_build_beside = window || importers_have_settings;
        Operation operation(callback);
        const auto lines = import_cloud(
            path, layer, settings, operation.progress(),
            [&](const std::vector<std::string>& reasons) { join_anyway(path, reasons, operation, window); });
        for (const std::string& line : lines) say(GLLogStream::FILTER, line, window);
        if (window && settings.draw_layers) draw_copy(layer, operation);
        mask |= mask_of(layer);
    } catch (const Failure&) {
        throw;
    } catch (...) {
        fail("Opening", "open", path, window);
    }
}

// The file is open; without the copy MeshLab draws the layer.
void PointCloudIo::draw_copy(MeshModel& layer, Operation& operation)
{
    if (Registry::instance().find(layer)) return;
    try {
        draw_as_cloud(layer, operation.progress());
    } catch (...) {
        say(GLLogStream::WARNING, "The layer is drawn by MeshLab: " + current_error(), true);
    }
}

// A warning in the log, and a question where there is a window. Throws Error(cancelled) if the user declines.
void PointCloudIo::join_anyway(const std::filesystem::path& path, const std::vector<std::string>& reasons,
                               Operation& operation, QWidget* window)
{
    const std::string name = path.filename().string();
    std::string question = name + " does not fit the clouds of this project.";
    for (const std::string& reason : reasons) {
        say(GLLogStream::WARNING, "Warning: " + name + ": " + reason, window);
        question += "\n\n" + reason;
    }
    if (window && !operation.ask(window, question + "\n\nOpen it all the same?"))
        throw Error(ErrorCode::cancelled, path, "not opened, because it does not fit the other clouds");
}

// What MeshLab's own plugins read and write knows no origin.
void PointCloudIo::warn_of_origin(const MeshModel& layer, const char* before, const char* after, const QWidget* window)
{
    const auto origin = Registry::instance().origin_of(document_of(layer));
    if (origin && *origin != Vec3d{0, 0, 0}) say(GLLogStream::WARNING, before + exact(*origin) + after, window);
}

void PointCloudIo::fail(const char* doing, const char* verb, const std::filesystem::path& path, const QWidget* window)
{
    const QString what = QString(doing) + " " + QString::fromStdString(path.string());
    if (const auto text = cancelled_text(what)) {
        say(GLLogStream::FILTER, text->toStdString(), window);
        if (window) say_cancelled(*text);
        throw Failure(*text);
    }
    const std::string error = error_about(path);
    say(GLLogStream::WARNING, std::string("Cannot ") + verb + " " + error, window);
    throw Failure(QString::fromStdString(error));
}

FormatList PointCloudIo::exportFormats() const { return formats_of(export_formats()); }

StockPlugin* PointCloudIo::exporter_instead(const QString& format, const MeshModel& layer) const
{
    return is_ours_to_write(layer) ? nullptr : stock_exporter(format, this);
}

RichParameterList PointCloudIo::save_parameters(const QString& format, const MeshModel& layer) const
{
    RichParameterList parameters;
    if (auto* stock = exporter_instead(format, layer)) {
        parameters = stock_save_parameters(*stock, format, layer);
    } else {
        Parameters asked;
        add_export_settings(asked, format.toLower().toStdString(), layer);
        add_to(parameters, asked);
        hide_unread_ticks(layer_of(layer));
    }
    add_field_buttons(parameters_of(parameters), &scene_of(document_of(layer)));
    return parameters;
}

// MeshLab does not pass the layer, so this is what either exporter can write.
void PointCloudIo::exportMaskCapability(const QString& format, int& capability, int& defaults) const
{
    capability = defaults = export_mask();
    if (auto* stock = stock_exporter(format, this)) {
        stock_mask(*stock, format, capability, defaults);
        capability |= export_mask();
    }
}

void PointCloudIo::save_layer(const QString& format, const QString& file_name, MeshModel& layer, int mask,
                              const RichParameterList& parameters, vcg::CallBackPos* callback)
{
    const std::filesystem::path path = absolute_path(file_name);
    QWidget* const window = window_with(layer);
    try {
        Operation::refuse_second();
        output_file(path);  // MeshLab's exporters would write into a tree
        if (auto* stock = exporter_instead(format, layer)) {
            int capability = 0, defaults = 0;
            stock_mask(*stock, format, capability, defaults);
            warn_after(stock_save(*stock, {format, file_name, parameters, callback, window}, layer, mask & capability));
            return warn_of_origin(layer,
                                  "MeshLab has saved the mesh with the coordinates shown. If it was made from a cloud "
                                  "of this project, they are relative to the origin ",
                                  ".", window);
        }
        // Scripts without a choice pass an empty mask; then all members are written.
        const int wanted = mask == 0 && !window ? export_mask() : mask;
        Operation operation(callback);
        for (const std::string& line :
             export_layer(path, layer, wanted, parameters_of(parameters), operation.progress()))
            say(GLLogStream::FILTER, line, window);
        keep_file_of(layer_of(layer));
    } catch (const Failure&) {
        throw;
    } catch (...) {
        fail("Saving", "save", path, window);
    }
}
