// The point clouds of one of MeshLab's views, and the native points that are hidden there. Child of the view.
//
// MeshLab requests one layer after the other. All of them are drawn at the first request, so that they share
// one budget.
#pragma once

#include "plugin/overlay/annotation_pass.h"
#include "plugin/overlay/clip_count.h"
#include "plugin/overlay/legend_box.h"
#include "plugin/overlay/legend_edit.h"
#include "plugin/overlay/map_overlay.h"
#include "plugin/overlay/painter.h"
#include "plugin/scene/scene_view.h"
#include "plugin/settings/settings.h"

#include <QObject>
#include <QString>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

class QAction;

namespace pcm::host {

class View : public QObject {
    Q_OBJECT

public:
    // The object of this view, made on first use. `decorator` is the action that MeshLab lists for a layer that we
    // draw.
    static View* of(SceneView& view, QAction* decorator);
    static View* find(const SceneView& view);  // null: it has not been used
    ~View() override;

    // The functions below require the view's context to be current, as it is in MeshLab's calls of decorators.

    // From now on the layer's tree is drawn in this view, and MeshLab's own points of the layer are hidden.
    void begin(const SceneLayer& layer);
    // Draws all layers that this view shows, unless that was done in this paint event. Returns the text about them for
    // MeshLab's box; nothing after the first call of a paint event, so that there is one box. Throws what drawing
    // throws.
    QString draw(const Settings& settings);
    // Whether the last paint event drew a tile of a snapshot.
    bool draws_tile() const { return tile_ != nullptr; }
    // Undoes begin().
    void end(int mesh_id);
    // The document is being closed: frees our GL objects. MeshLab has freed its own already.
    void close();
    // The layer shows no tree any more, or was removed.
    void forget(int mesh_id);
    // MeshLab's own points of the layer are to be seen again, although the decorator is on.
    void show_own(int mesh_id);

protected:
    bool eventFilter(QObject* receiver, QEvent* event) override;

private:
    struct Layer {
        std::shared_ptr<PaintedCloud> painted;
        bool native_hidden = false;
        std::optional<std::size_t> report;  // its index in report_.clouds, if it is in the picture
        std::uint64_t selected = 0;         // points
        ClipCount clip;
        // Styles whose notice about missing attributes was logged, and that notice.
        std::set<std::tuple<SplatMode, ColourMode, std::string>> noticed;
    };

    View(SceneView& view, QAction* decorator);
    void show_native(int mesh_id, bool show);
    SceneItem item_of(const SceneLayer& layer, const LayerCloud& tree, Layer& entry, const Settings& settings);
    void draw_scene(const Settings& settings);
    void draw_over_clouds(const MapSettings& map);
    QString describe(const Settings& settings) const;
    FrameReport draw_tile(const pcm::Camera& view, const std::vector<SceneItem>& items, RenderOptions options);
    void draw_legends(const std::vector<SceneLayer*>& drawn, const ColourSettings& settings, const SnapshotTile& tile);
    bool click_legend(const QEvent& event);
    bool edit_legend(const QEvent& event);
    void log_notices(const std::vector<SceneLayer*>& drawn, const CloudStyle& asked);
    void look_for_replaced(const std::vector<SceneLayer*>& drawn);
    void drop(Layer& layer);
    void drop_picture();
    void reconcile();
    void hide_native_after_edit();
    void publish_state();

    SceneView& view_;
    QAction* decorator_;
    std::map<int, Layer> layers_;
    std::shared_ptr<Painter> painter_;
    Picture picture_;
    pcm::Camera shown_;              // camera of picture_
    std::unique_ptr<Picture> tile_;  // while a tiled snapshot is being taken
    bool drawn_ = false;             // in the current paint event
    FrameReport report_;             // report of the last paint event
    QString text_;                   // about report_
    bool look_again_ = false;
    AnnotationPass annotations_;
    MapOverlay map_;
    LegendBox legend_box_;
    LegendEdit legend_edit_;
    std::vector<LayerLegend> legends_;  // legends of the last paint event
    QString problem_;                   // with the settings; logged once
    bool clicked_legend_ = false;       // the mouse button is down there
    int frame_ = 0;
    bool edited_ = false;  // an edit tool was on at the last paint event, in any view of the document
};

}  // namespace pcm::host
