// The shapes that were fitted to the clouds of a document. Views show them whichever tool is active, filters and tools
// add to them, and project files keep them. GUI thread.
//
// They are in the source coordinates of their clouds. Views show them where the matrix of the layer puts the cloud.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/primitives/primitive_list.h"
#include "pcm/query/point_set.h"
#include "plugin/host/registry.h"

#include <common/interfaces.h>

#include <QObject>
#include <QTimer>

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm::host {

// What Primitive::cloud is for the cloud of a layer: the folder of its tree, or the label of an ordinary layer.
std::string cloud_name(const MeshModel& layer);

class PrimitiveBook : public QObject {
    Q_OBJECT

public:
    // One for each document.
    static PrimitiveBook& of(MeshDocument& document);

    const PrimitiveList& list() const { return list_; }
    // Passes on what `step` throws; the list is then as it was.
    void change(const std::function<void(PrimitiveList& list)>& step);
    // In place of the present ones, which cannot be had back.
    void replace(PrimitiveList list);

    // The one that is shown in bold.
    std::optional<std::size_t> selected() const { return selected_; }
    void select(std::optional<std::size_t> index);

    // The layer that shows the primitive's cloud; null: none does.
    MeshModel* layer_of(const Primitive& primitive) const;
    std::optional<Affine> placement_of(const Primitive& primitive) const;

    // The points that belong to a primitive, as they were found; null where that is not known: a project was opened, or
    // the cloud has changed.
    void keep_points(const Primitive& primitive, std::shared_ptr<const PointSet> points);
    std::shared_ptr<const PointSet> points_of(const Primitive& primitive) const;

signals:
    void changed();  // the list or the selection

private:
    explicit PrimitiveBook(MeshDocument& document);
    void show();
    void follow_matrices();
    bool is_drawn(const Tree& tree) const;

    MeshDocument& document_;
    PrimitiveList list_;
    std::optional<std::size_t> selected_;
    std::map<std::string, std::shared_ptr<const PointSet>> points_;  // by cloud and shape
    std::map<std::string, std::optional<Affine>> placements_;        // of the clouds, as drawn
    QTimer timer_;  // MeshLab does not say when it changes a layer's matrix
};

// Makes project files keep the primitives of documents, as the element PointCloudPrimitives. Once per program.
void keep_primitives_in_projects();

}  // namespace pcm::host
