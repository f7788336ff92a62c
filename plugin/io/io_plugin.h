// Opens point clouds in MeshLab: trees (NAME.pct, or the index.pct in it) and LAS files.
#pragma once

#include <common/interfaces.h>

class PointCloudIo : public QObject, public MeshIOInterface {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(MESH_IO_INTERFACE_IID)
    Q_INTERFACES(MeshIOInterface)

public:
    QString pluginName() const override { return "IOPointCloud"; }
    QList<Format> importFormats() const override;
    QList<Format> exportFormats() const override { return {}; }
    void GetExportMaskCapability(QString& format, int& capability, int& defaults) const override;

    bool open(const QString& format, const QString& file_name, MeshModel& layer, int& mask,
              const RichParameterList& parameters, vcg::CallBackPos* callback, QWidget* parent) override;
    bool save(const QString& format, const QString& file_name, MeshModel& layer, const int mask,
              const RichParameterList& parameters, vcg::CallBackPos* callback, QWidget* parent) override;
};
