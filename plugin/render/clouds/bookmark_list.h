// The camera bookmarks of a document: added, gone to, renamed, deleted, exported and imported as a camera path.
#pragma once

#include <common/interfaces.h>

#include <QPointer>
#include <QTableWidget>
#include <QWidget>

#include <functional>

class GLArea;

namespace pcm::host {

// GUI thread.
class BookmarkList : public QWidget {
    Q_OBJECT

public:
    explicit BookmarkList(QWidget* parent);

    // The view whose camera is added and changed; null: none.
    void refresh(GLArea* view);

private:
    void fill();
    void add();
    void go_to();
    void remove();
    void write();
    void read();
    int chosen() const;  // -1: none
    void guarded(const std::function<void(GLArea& view, MeshDocument& document)>& work);

    QPointer<QWidget> view_;
    QPointer<MeshDocument> document_;
    QTableWidget* table_ = nullptr;
    bool filling_ = false;
};

}  // namespace pcm::host
