// MeshLab's documents, layers and views as the scene that tools and panels know, and back. GUI thread.
#pragma once

#include "plugin/scene/scene_view.h"

class GLArea;
class MeshDocument;
class MeshModel;
class QMainWindow;

namespace pcm::host {

// Made at the first request; it lives as long as the document.
Scene& scene_of(const MeshDocument& document);
MeshDocument& document_of(const Scene& scene);

// The scene of the layer's document.
SceneLayer& layer_of(const MeshModel& model);
MeshModel& model_of(const SceneLayer& layer);

// Made at the first request; it lives as long as the area.
SceneView& view_of(GLArea& area);
GLArea& area_of(const SceneView& view);

// The view of MeshLab's window that the user works in: of the open project's, the one with the keyboard focus, else the
// first. Null: there is none.
SceneView* current_view(const QMainWindow& window);

}  // namespace pcm::host
