// The panels of tools in MeshLab's window. GUI thread.
#pragma once

class GLArea;
class QDockWidget;

namespace pcm::host {

// Shows a tool's panel beside the panel "Point Cloud", in front of it.
void show_dock(const GLArea& view, QDockWidget& dock);

}  // namespace pcm::host
