// What MeshLab draws of layers itself, in a view. GUI thread.
#pragma once

#include "plugin/scene/scene_view.h"

#include <functional>

class MeshModel;
class QAction;

namespace pcm::host {

// Draws the layer's points in their own colours, without light, in all views. MeshLab also shades points without
// normals, which makes them dark. Does nothing without a window.
void draw_unshaded(MeshModel& layer);

// Whether MeshLab draws the layer's faces in the view.
bool draws_faces(const SceneView& view, const SceneLayer& layer);
// Calls `visit` with the corners of each face, in the views' coordinates before the layer's matrix.
void visit_faces(const SceneLayer& layer,
                 const std::function<void(const Vec3d& a, const Vec3d& b, const Vec3d& c)>& visit);

// The functions below require the view's context to be current.
void make_current(SceneView& view);

// Shows MeshLab's own points of the layer, or hides them. False: there is no such layer, or nothing is drawn yet.
bool show_own_points(SceneView& view, int layer_id, bool show);

// MeshLab draws selected vertices before decorators, so that our points cover them. Draws them once more, as MeshLab
// does in this view, if its button for that is on.
void draw_selected_vertices(SceneView& view, const SceneLayer& layer);

// Whether MeshLab lists the decorator of this action for the layer: it is switched on in the view.
bool is_listed(const SceneView& view, int layer_id, QAction* decorator);

// Whether the view has MeshLab's lines of information at its bottom.
bool shows_information(const SceneView& view);

}  // namespace pcm::host
