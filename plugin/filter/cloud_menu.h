// The submenu Filters > Point Clouds: everything that works on point clouds, of all plugins, in the order of the work.
// MeshLab lists filters by its own classes, each in several menus, and tools elsewhere.
#pragma once

namespace pcm::host {

// Adds the submenu when MeshLab's window is there, and whenever MeshLab has made its menu anew. Does nothing without a
// window. Called once.
void add_cloud_menu();

}  // namespace pcm::host
