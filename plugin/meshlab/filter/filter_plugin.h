// Shows the table of filters (plugin/filter/filter.h) to MeshLab.
#pragma once

#include "plugin/meshlab/plugin_bases.h"

class PointCloudFilters : public QObject, public pcm::host::FilterBase {
    Q_OBJECT
    Q_INTERFACES(PCM_FILTER_INTERFACE)

public:
    PointCloudFilters();
    QString pluginName() const override { return "FilterPointCloud"; }
    QString name_of(int filter) const override;
    QString info_of(int filter) const override;
    int classes_of(PluginAction* action) const override;
    int postCondition(PluginAction*) const override;
    RichParameterList parameters_for(PluginAction* action, const MeshDocument& document) override;
    Values run(PluginAction* action, MeshDocument& document, const RichParameterList& parameters,
               vcg::CallBackPos* callback) override;

private:
    int number_of(PluginAction* action) const;

    bool applied_ = false;      // any filter: MeshLab has made its menus
    bool resets_view_ = false;  // after the last filter
    mutable bool dialog_without_layer_ = false;
};
