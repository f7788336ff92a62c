// Which layer of which document shows which tree.
//
// MeshLab's layers are in memory; ours are a small proxy mesh and a tree on disk. The registry connects the two, keyed
// by (document, mesh id), for the lifetime of the layer: MeshLab signals when a layer or a document is removed. An
// ordinary layer, whose vertices are the cloud, may have a drawn copy (drawn_copy.h): a tree that only views use. GUI
// thread only.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/point_cloud.h"
#include "plugin/meshlab/layer_source.h"
#include "plugin/meshlab/layer_state.h"
#include "plugin/scene/layer_cloud.h"

#include <QObject>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

class GLArea;
class MeshDocument;
class MeshModel;
class QMainWindow;

namespace pcm::host {

struct Proxy;

struct TreeLayer : LayerCloud {
    // MeshLab's vertices when the tree was attached.
    LayerState state;
    std::shared_ptr<const Proxy> sample;  // null for a drawn copy
    LayerState glance;                    // for a drawn copy: a part of its vertices
};

class Registry : public QObject {
    Q_OBJECT

public:
    // Never destroyed, as documents may be destroyed after any static object.
    static Registry& instance();

    // The document's origin; chosen for `box` if the document has none yet.
    Vec3d origin_for(MeshDocument& document, const Box3d& box);
    std::optional<Vec3d> origin_of(const MeshDocument& document) const;

    // Attaches a tree to a layer, replacing its former tree, and tags the layer's mesh with the tree's folder.
    void attach(MeshModel& layer, TreeLayer tree);
    void detach(MeshModel& layer);
    std::optional<TreeLayer> find(const MeshModel& layer) const;

    // Gives an ordinary layer the tree that views draw instead of its vertices, replacing a former one.
    void attach_copy(MeshModel& layer, TreeLayer tree);
    void drop_copy(MeshModel& layer);
    // What views draw: the layer's tree, or its drawn copy.
    std::optional<TreeLayer> drawn(const MeshModel& layer) const;

    // The file that a layer's vertices came from; null: none.
    void set_source(MeshModel& layer, std::shared_ptr<const LayerSource> source);
    std::shared_ptr<const LayerSource> source_of(const MeshModel& layer) const;

signals:
    // Direct; `document` is alive, but may be busy.
    void attached(MeshDocument* document, int mesh_id);
    // The layer was removed or shows no tree any more.
    void detached(MeshDocument* document, int mesh_id);
    // Views are to show MeshLab's own points of the layer again, which exists.
    void copy_dropped(MeshDocument* document, int mesh_id);

private:
    Registry() = default;
    void watch(MeshDocument& document);
    void forget_lost(MeshDocument& document);
    void layer_removed(MeshDocument* document, int mesh_id);
    void document_destroyed(MeshDocument* document);
    void give_memory_back();

    using LayerKey = std::pair<const MeshDocument*, int>;
    std::map<LayerKey, TreeLayer> layers_, copies_;
    std::map<LayerKey, std::shared_ptr<const LayerSource>> sources_;
    std::map<const MeshDocument*, Vec3d> origins_;
    std::set<const MeshDocument*> watched_;
};

// The views that show a document; none in meshlabserver.
std::vector<GLArea*> views_of(const MeshDocument& document);

// MeshLab's window around a view; null while it has none.
QMainWindow* window_of(const GLArea& area);

// Names of per-mesh attributes (std::string): the folder of a layer's tree, and the format of a layer's file. MeshLab
// may empty a document without a signal and use ids again; a layer without the tag has nothing of what was kept.
inline constexpr const char* tree_tag = "pcm_tree";
inline constexpr const char* source_tag = "pcm_source";

}  // namespace pcm::host
