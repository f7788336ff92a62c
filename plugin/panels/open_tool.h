// Starts one of the tools after a filter whose results it shows. GUI thread.
#pragma once

#include "plugin/scene/scene.h"

namespace pcm::host {

// As soon as the scene is not busy: starts the tool of this name in the scene's window, unless a tool is on there. Does
// nothing without a window.
void open_tool(Scene& scene, const QString& name);

}  // namespace pcm::host
