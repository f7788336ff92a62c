#include "plugin/meshlab/native_drawing.h"

#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/meshlab.h"
#include "plugin/meshlab/registry.h"

namespace pcm::host {

namespace {

// Null: nothing is drawn yet.
MLSceneGLSharedDataContext* buffers_of(GLArea& area) { return area.mvc() ? area.mvc()->sharedDataContext() : nullptr; }

}  // namespace

void draw_unshaded(MeshModel& layer)
{
    for (GLArea* view : views_of(document_of(layer))) {
        MLSceneGLSharedDataContext* const shared = buffers_of(*view);
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

bool draws_faces(const SceneView& view, const SceneLayer& layer)
{
    GLArea& area = area_of(view);
    MLSceneGLSharedDataContext* const shared = buffers_of(area);
    if (!shared || model_of(layer).cm.fn == 0 || !view.is_shown(layer)) return false;
    MLRenderingData data;
    shared->getRenderInfoPerMeshView(layer.id(), area.context(), data);
    return data.isPrimitiveActive(MLRenderingData::PR_SOLID);
}

void visit_faces(const SceneLayer& layer,
                 const std::function<void(const Vec3d& a, const Vec3d& b, const Vec3d& c)>& visit)
{
    const auto corner = [](const CFaceO& face, int i) {
        const Point3m& p = face.cP(i);
        return Vec3d{double(p[0]), double(p[1]), double(p[2])};
    };
    for (const CFaceO& face : model_of(layer).cm.face)
        if (!face.IsD()) visit(corner(face, 0), corner(face, 1), corner(face, 2));
}

void make_current(SceneView& view) { area_of(view).makeCurrent(); }

bool show_own_points(SceneView& view, int layer_id, bool show)
{
    GLArea& area = area_of(view);
    MLSceneGLSharedDataContext* const shared = buffers_of(area);
    if (!shared || !area.md()->getMesh(layer_id)) return false;
    const auto points = MLRenderingData::PR_POINTS;
    MLRenderingData data;
    shared->getRenderInfoPerMeshView(layer_id, area.context(), data);
    if (data.isPrimitiveActive(points) == show) return true;
    if (show) {
        MLRenderingData::RendAtts attributes;
        attributes[MLRenderingData::ATT_NAMES::ATT_VERTPOSITION] = true;
        attributes[MLRenderingData::ATT_NAMES::ATT_VERTCOLOR] = true;
        data.set(points, attributes);
    } else {
        data.set(points, false);
    }
    shared->setRenderingDataPerMeshView(layer_id, area.context(), data);
    shared->manageBuffers(layer_id);
    return true;
}

void draw_selected_vertices(SceneView& view, const SceneLayer& layer)
{
    GLArea& area = area_of(view);
    CMeshO& mesh = model_of(layer).cm;
    MLSceneGLSharedDataContext* const shared = buffers_of(area);
    MLRenderingData data;
    MLPerViewGLOptions options;
    if (mesh.svn == 0 || !shared) return;
    shared->getRenderInfoPerMeshView(layer.id(), area.context(), data);
    if (!data.get(options) || !options._sel_enabled || !options._vertex_sel) return;
    auto buffers = vcg::tri::Allocator<CMeshO>::FindPerMeshAttribute<MLSelectionBuffers*>(
        mesh, MLDefaultMeshDecorators::selectionAttName());
    if (!vcg::tri::Allocator<CMeshO>::IsValidHandle(mesh, buffers) || !buffers()) return;
    buffers()->drawSelection(MLSelectionBuffers::ML_PERVERT_SEL);
}

bool is_listed(const SceneView& view, int layer_id, QAction* decorator)
{
    return area_of(view).iPerMeshDecoratorsListMap.value(layer_id).contains(decorator);
}

bool shows_information(const SceneView& view) { return area_of(view).infoAreaVisible; }

}  // namespace pcm::host
