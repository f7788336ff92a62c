// What MeshLab loads of this plugin's own file.
#pragma once

#include "plugin/meshlab/render/render_plugin.h"

class LoadedDecorator final : public PointCloudDecorator {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(PCM_DECORATE_IID)
};
