// The panels of tools in MeshLab's window. GUI thread.
#pragma once

#include "plugin/scene/scene_view.h"

class QDockWidget;
class QWidget;

namespace pcm::host {

// Shows a tool's panel next to the panel "Point Cloud", in front of it, no wider than a panel has to be. Ctrl+Z and
// Ctrl+Shift+Z in the panel are the view's, whatever was clicked there last, except in a field whose typing they take
// back.
void show_dock(SceneView& view, QDockWidget& dock);

// Puts the form into the panel, with scroll bars where it does not fit. A progress bar or a button that is hidden and
// shown keeps its place.
void fill_dock(QDockWidget& dock, QWidget* form);
void keep_place(QWidget& widget);

}  // namespace pcm::host
