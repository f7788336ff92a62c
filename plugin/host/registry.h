// Which layer of which document shows which tree.
//
// MeshLab's layers are in memory; ours are a small proxy mesh and a tree on disk. The registry holds the tie between
// the two, keyed by (document, mesh id), for as long as the layer lives: MeshLab tells us when a layer or a document
// goes. GUI thread only.
#pragma once

#include "pcm/cloud/geometry.h"
#include "plugin/host/layer_source.h"
#include "pcm/point_cloud.h"

#include <common/interfaces.h>

#include <QObject>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

class GLArea;

namespace pcm::host {

struct TreeLayer {
    std::shared_ptr<PointCloud> cloud;
    Vec3d origin{};        // of the document: MeshLab's coordinates are source coordinates minus this
    bool has_rgb = false;  // colours worth showing
};

class Registry : public QObject {
    Q_OBJECT

public:
    // Never destroyed: documents may outlive every order of static destruction.
    static Registry& instance();

    // The tree at `path` (folder or index file). Layers that show the same tree share one PointCloud, and so one L2,
    // unless the tree has been built anew in between. Errors: those of Tree::open.
    std::shared_ptr<PointCloud> open(const std::filesystem::path& path);

    // The document's origin; chosen for `box` when the document has none yet.
    Vec3d origin_for(MeshDocument& document, const Box3d& box);
    std::optional<Vec3d> origin_of(const MeshDocument& document) const;

    // Ties a layer to a tree, in place of the one it had, and tags the layer's mesh with the tree's folder.
    void attach(MeshModel& layer, TreeLayer tree);
    void detach(MeshModel& layer);
    std::optional<TreeLayer> find(const MeshModel& layer) const;

    // Ties a layer to the file that its vertices came from; null unties it.
    void set_source(MeshModel& layer, std::shared_ptr<const LayerSource> source);
    std::shared_ptr<const LayerSource> source_of(const MeshModel& layer) const;

signals:
    // Direct; `document` is alive, but may be busy.
    void attached(MeshDocument* document, int mesh_id);
    // The layer is gone or shows no tree any more.
    void detached(MeshDocument* document, int mesh_id);

private:
    Registry() = default;
    void watch(MeshDocument& document);
    void layer_removed(MeshDocument* document, int mesh_id);
    void document_destroyed(MeshDocument* document);

    using LayerKey = std::pair<const MeshDocument*, int>;
    using TreeKey =
        std::tuple<std::string, std::uint64_t, std::uint64_t, std::int64_t>;  // folder and its index's identity
    std::map<LayerKey, TreeLayer> layers_;
    std::map<LayerKey, std::shared_ptr<const LayerSource>> sources_;
    std::map<const MeshDocument*, Vec3d> origins_;
    std::set<const MeshDocument*> watched_;
    std::map<TreeKey, std::weak_ptr<PointCloud>> clouds_;
};

// The views that show a document; none in meshlabserver.
std::vector<GLArea*> views_of(const MeshDocument& document);

// Name of the per-mesh attribute (std::string) that holds the folder of a layer's tree.
inline constexpr const char* tree_tag = "pcm_tree";

}  // namespace pcm::host
