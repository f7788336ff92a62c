// Filters on point cloud trees. They take paths, so that a script needs no layer.
#pragma once

#include <common/interfaces.h>

#include <string>
#include <vector>

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
    int postCondition(QAction*) const override { return MeshModel::MM_NONE; }
    // The overload with a document: the other one is called with a null reference when there is no layer.
    void initParameterSet(QAction* action, MeshDocument& document, RichParameterList& parameters) override;
    bool applyFilter(QAction* action, MeshDocument& document, const RichParameterList& parameters,
                     vcg::CallBackPos* callback) override;

private:
    enum { build_tree_filter, append_filter, delete_filter, compact_filter, tree_information_filter };

    void build(MeshDocument& document, const RichParameterList& parameters, vcg::CallBackPos* callback);
    void information(MeshDocument& document, const RichParameterList& parameters);
    void say(const std::string& line) { Log(GLLogStream::FILTER, line); }
    void say(const std::vector<std::string>& lines)
    {
        for (const std::string& line : lines) say(line);
    }

    bool information_given_ = false;
};
