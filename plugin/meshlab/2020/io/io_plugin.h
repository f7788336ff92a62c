// Opens point clouds in MeshLab: trees (NAME.pct, or any file in it) and files of every format that the core
// reads.
#pragma once

#include "plugin/meshlab/2020/meshlab.h"

#include <filesystem>
#include <string>
#include <vector>

namespace pcm::host {
class Operation;
}

class PointCloudIo : public QObject, public MeshIOInterface {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(MESH_IO_INTERFACE_IID)
    Q_INTERFACES(MeshIOInterface)

public:
    PointCloudIo();
    QString pluginName() const override { return "IOPointCloud"; }
    QList<Format> importFormats() const override;
    QList<Format> exportFormats() const override;
    void initGlobalParameterSet(QAction*, RichParameterList& parameters) override;
    void initPreOpenParameter(const QString& format, const QString& file_name, RichParameterList& parameters) override;
    void initOpenParameter(const QString& format, MeshModel& layer, RichParameterList& parameters) override;
    void initSaveParameter(const QString& format, MeshModel& layer, RichParameterList& parameters) override;
    void GetExportMaskCapability(QString& format, int& capability, int& defaults) const override;

    bool open(const QString& format, const QString& file_name, MeshModel& layer, int& mask,
              const RichParameterList& parameters, vcg::CallBackPos* callback, QWidget* parent) override;
    bool save(const QString& format, const QString& file_name, MeshModel& layer, const int mask,
              const RichParameterList& parameters, vcg::CallBackPos* callback, QWidget* parent) override;

private:
    // Writes to the log, and without a window also to standard output: meshlabserver does not print the log of imports.
    void say(GLLogStream::Levels level, const std::string& line, const QWidget* window);
    void report_failure(const char* doing, const char* verb, const std::filesystem::path& path, const QWidget* window);
    void join_anyway(const std::filesystem::path& path, const std::vector<std::string>& reasons,
                     pcm::host::Operation& operation, QWidget* window);
    void draw_copy(MeshModel& layer, pcm::host::Operation& operation);
    bool hand_over_open(MeshIOInterface& stock, const QString& format, const QString& file_name, MeshModel& layer,
                        int& mask, const RichParameterList& parameters, vcg::CallBackPos* callback, QWidget* parent);
    // MeshLab's exporter if it is to write this layer, else null.
    MeshIOInterface* exporter_instead(const QString& format, const MeshModel& layer) const;
    bool hand_over_save(MeshIOInterface& stock, const QString& format, const QString& file_name, MeshModel& layer,
                        int mask, const RichParameterList& parameters, vcg::CallBackPos* callback, QWidget* parent);
};
