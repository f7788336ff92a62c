#include "plugin/meshlab/2020/shading.h"

#include "plugin/meshlab/2020/meshlab.h"
#include "plugin/meshlab/2020/registry.h"

namespace pcm::host {

void draw_unshaded(MeshModel& layer)
{
    for (GLArea* view : views_of(*layer.parent)) {
        MLSceneGLSharedDataContext* shared = view->mvc() ? view->mvc()->sharedDataContext() : nullptr;
        if (!shared) continue;
        const auto points = MLRenderingData::PR_POINTS;
        MLRenderingData data;
        MLRenderingData::RendAtts attributes;
        MLPerViewGLOptions options;
        shared->getRenderInfoPerMeshView(layer.id(), view->context(), data);
        if (!data.isPrimitiveActive(points) || !data.get(points, attributes) || !data.get(options)) continue;
        attributes[MLRenderingData::ATT_NAMES::ATT_VERTNORMAL] = false;
        options._perpoint_noshading = true;
        data.set(points, attributes);
        data.set(options);
        shared->setRenderingDataPerMeshView(layer.id(), view->context(), data);
        shared->manageBuffers(layer.id());
    }
}

}  // namespace pcm::host
