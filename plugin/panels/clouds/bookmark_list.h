// The camera bookmarks of a document: added, gone to, renamed, deleted, exported and imported as a camera path.
#pragma once

#include "plugin/scene/scene_view.h"

#include <QPointer>
#include <QTableWidget>
#include <QWidget>

#include <functional>

namespace pcm::host {

// GUI thread.
class BookmarkList : public QWidget {
    Q_OBJECT

public:
    explicit BookmarkList(QWidget* parent);

    // The view whose camera is added and changed; null: none.
    void refresh(SceneView* view);

private:
    void fill();
    void add();
    void go_to();
    void remove();
    void write();
    void read();
    int chosen() const;  // -1: none
    void guarded(const std::function<void(SceneView& view, Scene& scene)>& work);

    QPointer<SceneView> view_;
    QPointer<Scene> scene_;
    QTableWidget* table_ = nullptr;
    bool filling_ = false;
};

}  // namespace pcm::host
