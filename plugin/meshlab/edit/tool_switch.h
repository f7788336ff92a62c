// One click switches from one tool to another.
//
// MeshLab disables the buttons of all tools but the one that is on, and expects that none is on when it starts one. GUI
// thread.
#pragma once

#include <QList>

class QAction;

namespace pcm::host {

// Lets the action of a tool be triggered while another tool is on, which is ended first. To be called before MeshLab
// connects to the action.
void make_switchable(QAction& tool);

// A bar with the tools at the left edge of MeshLab's windows: of the toolbar at the top, which has those of all
// plugins, most are out of sight in a window of usual width.
void show_tool_bar(const QList<QAction*>& tools);

}  // namespace pcm::host
