// Shows the table of filters (plugin/filter/filter.h) to MeshLab.
#pragma once

#include "plugin/meshlab/2020/meshlab.h"

class PointCloudFilters : public QObject, public MeshFilterInterface {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(MESH_FILTER_INTERFACE_IID)
    Q_INTERFACES(MeshFilterInterface)

public:
    PointCloudFilters();
    QString pluginName() const override { return "FilterPointCloud"; }
    QString filterName(FilterIDType filter) const override;
    QString filterInfo(FilterIDType filter) const override;
    FilterClass getClass(QAction* action) override;
    FILTER_ARITY filterArity(QAction*) const override { return NONE; }
    int getPreConditions(QAction*) const override { return MeshModel::MM_NONE; }
    int postCondition(QAction*) const override;
    // The overload with a document: MeshLab calls the other one with a null reference when there is no layer.
    void initParameterSet(QAction* action, MeshDocument& document, RichParameterList& parameters) override;
    bool applyFilter(QAction* action, MeshDocument& document, const RichParameterList& parameters,
                     vcg::CallBackPos* callback) override;

private:
    bool applied_ = false;      // any filter: MeshLab has made its menus
    bool resets_view_ = false;  // after the last filter
    mutable bool dialog_without_layer_ = false;
};
