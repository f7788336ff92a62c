#include "plugin/meshlab/2020/io/io_plugin.h"

#include "pcm/io/formats.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/system/tree_folder.h"
#include "plugin/meshlab/2020/document_scene.h"
#include "plugin/meshlab/2020/drawn_copy.h"
#include "plugin/meshlab/2020/io/export.h"
#include "plugin/meshlab/2020/io/export_dialog.h"
#include "plugin/meshlab/2020/io/formats.h"
#include "plugin/meshlab/2020/io/import.h"
#include "plugin/meshlab/2020/io/stock.h"
#include "plugin/meshlab/2020/layer.h"
#include "plugin/meshlab/2020/native_drawing.h"
#include "plugin/meshlab/2020/registry.h"
#include "plugin/meshlab/2020/rich_parameters.h"
#include "plugin/panels/cancelled.h"
#include "plugin/panels/field_buttons.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

#include <QDir>
#include <QFileInfo>
#include <QTimer>

#include <cstdio>

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

QList<MeshIOInterface::Format> formats_of(const std::vector<FileType>& types)
{
    QList<MeshIOInterface::Format> list;
    for (const FileType& type : types) list << MeshIOInterface::Format(type.label, type.extension);
    return list;
}

// MeshLab's dialog asks for these, where it has a window.
void add_file_parameters(const std::filesystem::path& path, RichParameterList& parameters)
{
    for (QWidget* widget : QApplication::allWidgets()) {
        if (!widget->inherits("GLArea")) continue;
        Parameters asked;
        add_file_settings(asked, path, parameters_of(*static_cast<GLArea*>(widget)->glas.currentGlobalParamSet));
        add_to(parameters, asked);
        return;
    }
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
    connect(&Registry::instance(), &Registry::attached, this, [](const MeshDocument* document) {
        for (const SceneView* view : scene_of(*document).views()) ExportDialog::take_over(*view);
    });
}

QList<MeshIOInterface::Format> PointCloudIo::importFormats() const { return formats_of(import_formats()); }

void PointCloudIo::initGlobalParameterSet(QAction*, RichParameterList& parameters)
{
    Parameters defaults;
    add_global_settings(defaults);
    add_to(parameters, defaults);
}

void PointCloudIo::initPreOpenParameter(const QString& format, const QString& file_name, RichParameterList& parameters)
{
    const std::filesystem::path path = absolute_path(file_name);
    if (format.compare(tree_extension, Qt::CaseInsensitive) == 0 || is_file_of_tree(path)) return;
    if (is_point_cloud(path))
        add_file_parameters(path, parameters);
    else if (auto* stock = stock_importer(format, this))
        stock->initPreOpenParameter(format, file_name, parameters);
    add_field_buttons(parameters_of(parameters), nullptr);
}

void PointCloudIo::initOpenParameter(const QString&, MeshModel& layer, RichParameterList&)
{
    // MeshLab has just decided how to draw the layer.
    const auto source = Registry::instance().source_of(layer);
    if (source && !source->has(AttributePlace::Kind::normal)) draw_unshaded(layer);
}

bool PointCloudIo::open(const QString& format, const QString& file_name, MeshModel& layer, int& mask,
                        const RichParameterList& parameters, vcg::CallBackPos* callback, QWidget* parent)
{
    errorMessage.clear();
    const std::filesystem::path path = absolute_path(file_name);
    try {
        Operation::refuse_second();
        clear_layer(layer);
        if (!is_point_cloud(path))
            if (auto* stock = stock_importer(format, this))
                return hand_over_open(*stock, format, file_name, layer, mask, parameters, callback, parent);
        const ImportSettings settings = read_import_settings(parameters_of(parameters));
        Operation operation(callback);
        const auto lines = import_cloud(
            path, layer, settings, operation.progress(),
            [&](const std::vector<std::string>& reasons) { join_anyway(path, reasons, operation, parent); });
        for (const std::string& line : lines) say(GLLogStream::FILTER, line, parent);
        if (parent && settings.draw_layers) draw_copy(layer, operation);
        mask |= mask_of(layer);
        return true;
    } catch (...) {
        report_failure("Opening", "open", path, parent);
        return false;
    }
}

// The file is open; without the copy MeshLab draws the layer.
void PointCloudIo::draw_copy(MeshModel& layer, Operation& operation)
{
    if (Registry::instance().find(layer)) return;
    try {
        draw_as_cloud(layer, operation.progress());
    } catch (...) {
        Log(GLLogStream::WARNING, "The layer is drawn by MeshLab: " + current_error());
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

bool PointCloudIo::hand_over_open(MeshIOInterface& stock, const QString& format, const QString& file_name,
                                  MeshModel& layer, int& mask, const RichParameterList& parameters,
                                  vcg::CallBackPos* callback, QWidget* parent)
{
    if (layer.parent) stock.setLog(&layer.parent->Log);
    stock.clearErrorString();
    const bool opened = stock.open(format, file_name, layer, mask, parameters, callback, parent);
    errorMessage = stock.errorMsg();
    stock.clearErrorString();
    const auto origin = Registry::instance().origin_of(*layer.parent);
    if (opened && origin && *origin != Vec3d{0, 0, 0})
        say(GLLogStream::WARNING,
            "This mesh is shown at its own coordinates, but the clouds of this project relative to the origin " +
                exact(*origin) + ".",
            parent);
    return opened;
}

// Inside a catch block.
void PointCloudIo::report_failure(const char* doing, const char* verb, const std::filesystem::path& path,
                                  const QWidget* window)
{
    const QString what = QString(doing) + " " + QString::fromStdString(path.string());
    if (const auto text = cancelled_text(what)) {
        errorMessage = *text;
        say(GLLogStream::FILTER, text->toStdString(), window);
        if (window) say_cancelled(*text);
        return;
    }
    const std::string error = error_about(path);
    errorMessage = QString::fromStdString(error);
    say(GLLogStream::WARNING, std::string("Cannot ") + verb + " " + error, window);
}

void PointCloudIo::say(GLLogStream::Levels level, const std::string& line, const QWidget* window)
{
    Log(level, line);
    if (window) return;
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
}

QList<MeshIOInterface::Format> PointCloudIo::exportFormats() const { return formats_of(export_formats()); }

MeshIOInterface* PointCloudIo::exporter_instead(const QString& format, const MeshModel& layer) const
{
    return is_ours_to_write(layer) ? nullptr : stock_exporter(format, this);
}

void PointCloudIo::initSaveParameter(const QString& format, MeshModel& layer, RichParameterList& parameters)
{
    if (auto* stock = exporter_instead(format, layer)) {
        stock->initSaveParameter(format, layer, parameters);
    } else {
        Parameters asked;
        add_export_settings(asked, format.toLower().toStdString(), layer);
        add_to(parameters, asked);
        hide_unread_ticks(layer_of(layer));
    }
    add_field_buttons(parameters_of(parameters), &scene_of(*layer.parent));
}

// MeshLab does not pass the layer, so this is what either exporter can write.
void PointCloudIo::GetExportMaskCapability(QString& format, int& capability, int& defaults) const
{
    capability = defaults = export_mask();
    if (auto* stock = stock_exporter(format, this)) {
        stock->GetExportMaskCapability(format, capability, defaults);
        capability |= export_mask();
    }
}

bool PointCloudIo::save(const QString& format, const QString& file_name, MeshModel& layer, const int mask,
                        const RichParameterList& parameters, vcg::CallBackPos* callback, QWidget* parent)
{
    errorMessage.clear();
    const std::filesystem::path path = absolute_path(file_name);
    try {
        Operation::refuse_second();
        output_file(path);  // MeshLab's exporters would write into a tree
        if (auto* stock = exporter_instead(format, layer))
            return hand_over_save(*stock, format, file_name, layer, mask, parameters, callback, parent);
        // meshlabserver without -m passes an empty mask; then all members are written.
        const int wanted = mask == 0 && !parent ? export_mask() : mask;
        Operation operation(callback);
        for (const std::string& line :
             export_layer(path, layer, wanted, parameters_of(parameters), operation.progress()))
            say(GLLogStream::FILTER, line, parent);
        keep_file_of(layer_of(layer));
        return true;
    } catch (...) {
        report_failure("Saving", "save", path, parent);
        return false;
    }
}

bool PointCloudIo::hand_over_save(MeshIOInterface& stock, const QString& format, const QString& file_name,
                                  MeshModel& layer, int mask, const RichParameterList& parameters,
                                  vcg::CallBackPos* callback, QWidget* parent)
{
    stock.setLog(&layer.parent->Log);
    stock.clearErrorString();
    QString name = format;
    int capability = 0, defaults = 0;
    stock.GetExportMaskCapability(name, capability, defaults);
    const bool saved = stock.save(format, file_name, layer, mask & capability, parameters, callback, parent);
    errorMessage = stock.errorMsg();
    stock.clearErrorString();
    const auto origin = Registry::instance().origin_of(*layer.parent);
    if (saved && origin && *origin != Vec3d{0, 0, 0})
        say(GLLogStream::WARNING,
            "MeshLab has saved the mesh with the coordinates shown. If it was made from a cloud of this project, they "
            "are "
            "relative to the origin " +
                exact(*origin) + ".",
            parent);
    return saved;
}
