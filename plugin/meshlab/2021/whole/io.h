// What MeshLab loads of the file that has all plugins: the importer, and with it the others.
#pragma once

#include "plugin/meshlab/2021/whole/parts.h"
#include "plugin/meshlab/io/io_plugin.h"

class PointCloudFile final : public PointCloudIo {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(PCM_IO_IID)

private:
    void was_listed() const final { parts_ = pcm::host::make_parts(); }

    mutable std::vector<std::unique_ptr<pcm::host::Part>> parts_;
};
