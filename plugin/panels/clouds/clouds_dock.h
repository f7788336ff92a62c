// The panel "Point Clouds" of MeshLab's window: the layers of clouds, moving by numbers, and camera bookmarks.
#pragma once

#include "plugin/scene/scene_view.h"

#include <QDockWidget>

#include <functional>

class QMainWindow;

namespace pcm::host {

class BookmarkList;
class LayerList;
class MoveFields;

// One for each window; it shows the scene of the window's current view. GUI thread.
class CloudsDock : public QDockWidget {
    Q_OBJECT

public:
    // The view of the window that the user works in; null: there is none.
    using CurrentView = std::function<SceneView*()>;

    // Makes the panel when the first tree is shown, behind the panel "Point Cloud". The entry "Point Clouds" in
    // MeshLab's menu View hides and shows it.
    static void show_for(const SceneView& view, CurrentView current_view);

private:
    CloudsDock(QMainWindow* window, CurrentView current_view);
    void refresh();

    CurrentView current_view_;
    LayerList* layers_;
    MoveFields* move_;
    BookmarkList* bookmarks_;
};

}  // namespace pcm::host
