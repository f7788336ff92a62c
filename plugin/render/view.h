// What we draw in one of MeshLab's views, and what we have hidden there. Child of the view.
#pragma once

#include "host/registry.h"
#include "render/painter.h"
#include "render/settings.h"

#include <QElapsedTimer>
#include <QObject>
#include <QString>

#include <map>
#include <memory>

class GLArea;
class QAction;

namespace pcm::host {

class View : public QObject {
    Q_OBJECT

public:
    // The view's own, made on first use. `decorator` is the action that MeshLab lists for a layer that we draw.
    static View* of(GLArea* area, QAction* decorator);
    static View* find(GLArea* area);
    ~View() override;

    // The following want the view's context current, as MeshLab's decorator calls have it.

    // From now on the layer's tree is drawn here, and MeshLab's own points of it are not.
    void begin(MeshModel& layer);
    // Draws; returns the text for MeshLab's info pane.
    QString draw(const MeshModel& layer, const TreeLayer& tree, const Settings& settings);
    // Undoes begin().
    void end(int mesh_id);
    // The whole document closes: frees what is ours on the graphics card. MeshLab has freed its own already.
    void close();
    // The layer shows no tree any more, or is gone.
    void forget(int mesh_id);

protected:
    bool eventFilter(QObject* receiver, QEvent* event) override;

private:
    struct Layer {
        std::shared_ptr<Painter> painter;
        bool native_hidden = false;
        bool drawn = false;  // in the current paint event
        FrameReport report;
    };

    View(GLArea* area, QAction* decorator);
    void show_native(int mesh_id, bool show);
    void reconcile();
    void publish_state();

    GLArea* area_;
    QAction* decorator_;
    std::map<int, Layer> layers_;
    bool look_again_ = false;
    int frame_ = 0;
};

}  // namespace pcm::host
