// What the tools of a view have in common: its camera, and MeshLab's own camera, which gets the events that a tool has
// no use for. GUI thread.
#pragma once

#include "plugin/edit/view_map.h"

#include <common/interfaces.h>

#include <optional>

class GLArea;
class QEvent;

namespace pcm::host {

// The camera of the picture that the view shows; nothing until it has painted a cloud.
std::optional<ViewMap> map_of(const GLArea& view);

// For observers such as tests: the camera as the property pcm_camera of the view.
void publish_camera(GLArea& view);

// MeshLab handles a mouse or wheel event as if no tool was on: the trackball turns, the wheel zooms, and a double click
// makes a point the pivot.
void give_to_camera(GLArea& view, const QEvent& event);

// MeshLab marks the current layer as modified when a tool is started. To be called in StartEdit() by a tool that
// changes no layer.
void keep_unmodified(MeshDocument& document);

}  // namespace pcm::host
