// The panel "Point Clouds" of MeshLab's window: the layers of clouds, moving by numbers, and camera bookmarks.
#pragma once

#include <QDockWidget>

class GLArea;
class QMainWindow;

namespace pcm::host {

class BookmarkList;
class LayerList;
class MoveFields;

// One for each window; it shows the document of the window's current view. GUI thread.
class CloudsDock : public QDockWidget {
    Q_OBJECT

public:
    // Makes the panel when the first tree is shown, behind the panel "Point Cloud". The entry "Point Clouds" in
    // MeshLab's menu View hides and shows it.
    static void show_for(const GLArea& area);

private:
    explicit CloudsDock(QMainWindow* window);
    void refresh();

    LayerList* layers_;
    MoveFields* move_;
    BookmarkList* bookmarks_;
};

}  // namespace pcm::host
