// What we draw in one of MeshLab's views, and what we have hidden there. Child of the view.
//
// MeshLab asks for one layer after the other; all of them are drawn when it asks for the first, so that they share one
// budget, by what the eye sees.
#pragma once

#include "plugin/host/registry.h"
#include "plugin/render/painter.h"
#include "plugin/render/settings.h"

#include <QObject>
#include <QString>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

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
    // Draws all layers that this view shows, unless it has in this paint; returns the text about this one for MeshLab's
    // info pane. Throws what drawing throws.
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
        std::shared_ptr<PaintedCloud> painted;
        bool native_hidden = false;
        std::optional<std::size_t> report;                // of it in report_, when it is in the picture
        std::set<std::pair<SplatMode, ColourMode>> told;  // of which the log has what the cloud lacks for them
    };

    View(GLArea* area, QAction* decorator);
    void show_native(int mesh_id, bool show);
    void draw_scene(const Settings& settings);
    FrameReport draw_tile(const pcm::Camera& view, const std::vector<SceneItem>& items, RenderOptions options);
    void tell_notices(const std::vector<MeshModel*>& drawn, const CloudStyle& asked);
    void drop(Layer& layer);
    void drop_picture();
    void reconcile();
    void publish_state();

    GLArea* area_;
    QAction* decorator_;
    std::map<int, Layer> layers_;
    std::shared_ptr<Painter> painter_;
    Picture picture_;
    pcm::Camera shown_;              // in picture_
    std::unique_ptr<Picture> tile_;  // of a snapshot that is being taken
    bool drawn_ = false;             // in the current paint event
    FrameReport report_;             // of it
    bool look_again_ = false;
    int frame_ = 0;
};

}  // namespace pcm::host
