// What MeshLab loads of this plugin's own file.
#pragma once

#include "plugin/meshlab/filter/filter_plugin.h"

class LoadedFilters final : public PointCloudFilters {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(PCM_FILTER_IID)
};
