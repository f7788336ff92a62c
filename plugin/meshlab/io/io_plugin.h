// Opens point clouds in MeshLab: trees (NAME.pct, or any file in it) and files of every format that the core
// reads.
#pragma once

#include "plugin/meshlab/plugin_bases.h"

#include <filesystem>
#include <string>
#include <vector>

namespace pcm::host {
class Operation;
}

class PointCloudIo : public QObject, public pcm::host::IoBase {
    Q_OBJECT
    Q_INTERFACES(PCM_IO_INTERFACE)

public:
    PointCloudIo();
    QString pluginName() const override { return "IOPointCloud"; }
    FormatList all_import_formats() const override;
    FormatList exportFormats() const override;
    void add_global_parameters(RichParameterList& parameters) override;
    RichParameterList parameters_before_open(const QString& format, const QString& file_name) const override;
    void opened(MeshModel& layer) override;
    RichParameterList save_parameters(const QString& format, const MeshModel& layer) const override;
    void exportMaskCapability(const QString& format, int& capability, int& defaults) const override;
    void open_layer(const QString& format, const QString& file_name, MeshModel& layer, int& mask,
                    const RichParameterList& parameters, vcg::CallBackPos* callback) override;
    void save_layer(const QString& format, const QString& file_name, MeshModel& layer, int mask,
                    const RichParameterList& parameters, vcg::CallBackPos* callback) override;

private:
    // Inside a catch block: writes to the log and throws what the user reads.
    [[noreturn]] void fail(const char* doing, const char* verb, const std::filesystem::path& path,
                           const QWidget* window);
    void join_anyway(const std::filesystem::path& path, const std::vector<std::string>& reasons,
                     pcm::host::Operation& operation, QWidget* window);
    void draw_copy(MeshModel& layer, pcm::host::Operation& operation);
    // MeshLab's exporter if it is to write this layer, else null.
    StockPlugin* exporter_instead(const QString& format, const MeshModel& layer) const;
    void warn_of_origin(const MeshModel& layer, const char* before, const char* after, const QWidget* window);
};
