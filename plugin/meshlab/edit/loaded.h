// What MeshLab loads of this plugin's own file.
#pragma once

#include "plugin/meshlab/edit/edit_plugin.h"

class LoadedTools final : public PointCloudTools {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(PCM_EDIT_IID)
};
