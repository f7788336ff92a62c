#include "plugin/meshlab/2020/edit/edit_tool.h"

#include "plugin/meshlab/2020/document_scene.h"

#include <QTimer>

namespace pcm::host {

namespace {

// MeshLab marks the current layer as modified when it has started a tool, and ours change none by that.
void keep_unmodified(MeshDocument& document)
{
    if (const MeshModel* layer = document.mm())
        QTimer::singleShot(0, &document, [document = &document, id = layer->id(), changed = layer->meshModified()] {
            if (MeshModel* shown = document->getMesh(id)) shown->setMeshModified(changed);
        });
}

}  // namespace

bool EditTool::StartEdit(MeshDocument& document, GLArea* area, MLSceneGLSharedDataContext*)
{
    setParent(area);  // the view does not delete its tools otherwise
    if (!tool_->start(view_of(*area))) return false;
    area_ = area;
    keep_unmodified(document);
    return true;
}

void EditTool::EndEdit(MeshDocument&, GLArea* area, MLSceneGLSharedDataContext*)
{
    if (area != area_) return;
    tool_->end();
    area_ = nullptr;
}

void EditTool::Decorate(MeshModel&, GLArea* area, QPainter* painter)
{
    if (area == area_) tool_->draw(painter);
}

void EditTool::mousePressEvent(QMouseEvent* event, MeshModel&, GLArea* area)
{
    if (area == area_) tool_->mousePressEvent(event);
}

void EditTool::mouseMoveEvent(QMouseEvent* event, MeshModel&, GLArea* area)
{
    if (area == area_) tool_->mouseMoveEvent(event);
}

void EditTool::mouseReleaseEvent(QMouseEvent* event, MeshModel&, GLArea* area)
{
    if (area == area_) tool_->mouseReleaseEvent(event);
}

void EditTool::wheelEvent(QWheelEvent* event, MeshModel&, GLArea* area)
{
    if (area == area_) tool_->wheelEvent(event);
}

void EditTool::keyPressEvent(QKeyEvent* event, MeshModel&, GLArea* area)
{
    if (area == area_) tool_->keyPressEvent(event);
}

void EditTool::keyReleaseEvent(QKeyEvent* event, MeshModel&, GLArea* area)
{
    if (area == area_) tool_->keyReleaseEvent(event);
}

}  // namespace pcm::host
