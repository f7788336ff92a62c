// Starts one of the tools after a filter whose results it shows. GUI thread.
#pragma once

#include "plugin/meshlab/2020/meshlab.h"

namespace pcm::host {

// As soon as the document is not busy: starts the tool of this name in the document's window, unless a tool is on
// there. Does nothing without a window.
void open_tool(MeshDocument& document, const QString& name);

}  // namespace pcm::host
