// What a view does when a tree is opened in it, before MeshLab paints it: it shows the tree instead of MeshLab's
// points, and looks at it obliquely if nothing else is shown and the camera is where MeshLab has put it. Child of the
// view.
#pragma once

#include <QObject>
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
};

}  // namespace pcm::host
