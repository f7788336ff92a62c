#include "plugin/meshlab/2020/render/selection.h"

#include "plugin/meshlab/2020/meshlab.h"

namespace pcm::host {

void draw_selected_vertices(GLArea& area, MeshModel& layer)
{
    if (layer.cm.svn == 0) return;
    MLSceneGLSharedDataContext* shared = area.mvc() ? area.mvc()->sharedDataContext() : nullptr;
    MLRenderingData data;
    MLPerViewGLOptions options;
    if (!shared) return;
    shared->getRenderInfoPerMeshView(layer.id(), area.context(), data);
    if (!data.get(options) || !options._sel_enabled || !options._vertex_sel) return;
    auto buffers = vcg::tri::Allocator<CMeshO>::FindPerMeshAttribute<MLSelectionBuffers*>(
        layer.cm, MLDefaultMeshDecorators::selectionAttName());
    if (!vcg::tri::Allocator<CMeshO>::IsValidHandle(layer.cm, buffers) || !buffers()) return;
    buffers()->drawSelection(MLSelectionBuffers::ML_PERVERT_SEL);
}

}  // namespace pcm::host
