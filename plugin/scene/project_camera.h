// The camera of a project's view, kept in its file: MeshLab keeps none. GUI thread.
#pragma once

namespace pcm::host {

// Lets project files keep the camera of the current view, in source coordinates (the text of a camera path with one
// frame), and gives it back when a project is opened. Called once.
void keep_camera_in_projects();

}  // namespace pcm::host
