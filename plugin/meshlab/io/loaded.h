// What MeshLab loads of this plugin's own file.
#pragma once

#include "plugin/meshlab/io/io_plugin.h"

class LoadedIo final : public PointCloudIo {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(PCM_IO_IID)
};
