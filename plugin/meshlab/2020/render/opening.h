// What a view does when a tree is opened in it, before MeshLab paints it: it shows the tree instead of MeshLab's
// points, and looks at it obliquely if nothing else is shown and the camera is where MeshLab has put it. It also gives
// back the first double click, which MeshLab may lose. Child of the view.
#pragma once

#include <QObject>
#include <QPoint>
#include <QSize>

#include <array>
#include <functional>
#include <optional>
#include <set>

class GLArea;
class MeshModel;

namespace pcm::host {

class Opening : public QObject {
    Q_OBJECT

public:
    using Show = std::function<void(GLArea& area, MeshModel& layer)>;
    using Track = std::array<float, 8>;  // MeshLab's trackball: turn, shift, scale

    // A tree was attached to a layer that `area` shows. `show` is called at the first paint event in which MeshLab
    // would draw the layer, with the view's context current.
    static void expect(GLArea& area, int mesh_id, const Show& show);

protected:
    bool eventFilter(QObject* receiver, QEvent* event) override;

private slots:
    // MeshLab has sent the place of a double click to whatever asked for it by this name.
    void place_sent(const QString& name);

private:
    explicit Opening(GLArea* area);
    void before_paint();
    void look();
    void set_background();

    GLArea* area_;
    Show show_;
    std::set<int> waiting_;  // layers that have not been painted yet
    std::set<int> known_;    // layers that were opened: one that is loaded again does not move the camera
    bool to_look_ = false;
    std::optional<Track> looked_;  // until the camera is moved
    QSize looked_size_;
    bool own_background_ = false;
    QPoint double_click_;  // the place of the last one
};

}  // namespace pcm::host
