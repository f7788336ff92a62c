// The decorator that draws point cloud trees.
//
// A decorator instead of one of MeshLab's render plugins: those are exclusive and must draw every layer themselves. A
// decorator draws after MeshLab's own layers and before the edit tools, so that both share the depth buffer and tools
// such as measuring work on our points.
#pragma once

#include "plugin/meshlab/plugin_bases.h"

class PointCloudDecorator : public QObject, public pcm::host::DecorateBase {
    Q_OBJECT
    Q_INTERFACES(PCM_DECORATE_INTERFACE)

public:
    PointCloudDecorator();
    QString pluginName() const override { return "DecoratePointCloud"; }
    QString decorationName(int) const override { return "Show Point Cloud"; }
    QString decorationInfo(int) const override;
    int getDecorationClass(PluginAction*) const override { return PerMesh; }
    bool isDecorationApplicable(PluginAction* action, const MeshModel& layer, QString& reason) const override;
    void initGlobalParameterList(PluginAction* action, RichParameterList& parameters) override;

    bool startDecorate(PluginAction* action, MeshModel& layer, const RichParameterList* parameters,
                       GLArea* area) override;
    void decorateMesh(PluginAction* action, MeshModel& layer, const RichParameterList* parameters, GLArea* area,
                      QPainter* painter, GLLogStream& log) override;
    void decorateDoc(PluginAction*, MeshDocument&, const RichParameterList*, GLArea*, QPainter*, GLLogStream&) override
    {
    }
    void endDecorate(PluginAction* action, MeshModel& layer, const RichParameterList* parameters,
                     GLArea* area) override;
    void endDecorate(PluginAction* action, MeshDocument& document, const RichParameterList* parameters,
                     GLArea* area) override;

private:
    // Switches the decorator on for a newly opened tree: MeshLab's decorators are off until the user asks for them.
    void show_when_idle(MeshDocument* document, int mesh_id);
    // The same without menus and panels, before MeshLab paints the layer.
    void show_at_first_paint(GLArea& area, int mesh_id);
    void list(GLArea& area, MeshModel& layer);
    void switch_on(GLArea& area, MeshModel& layer);
    bool is_first_listed(GLArea& area, const MeshModel& layer);
    bool is_on(const MeshModel& layer);  // in any view
    bool copy_layer(MeshModel& layer);   // false: the log says why
    void copy_again(MeshDocument& document, int mesh_id);
};
