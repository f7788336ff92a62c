// One cloud's renderer in one GL share group.
//
// The views of a MeshLab project share buffers, so they share renderers too; two projects share nothing. All clouds of
// a share group live in one L1. GUI thread only, except that loader threads wake it.
#pragma once

#include "gl/cloud_renderer.h"

#include <QObject>
#include <QPointer>
#include <QWidget>

#include <memory>
#include <vector>

namespace pcm::host {

class Painter : public QObject {
    Q_OBJECT

public:
    // The painter of `cloud` in the current context's share group, with an L1 of this capacity.
    static std::shared_ptr<Painter> of(const std::shared_ptr<PointCloud>& cloud, std::uint64_t l1_bytes);
    ~Painter() override;

    // A context of the share group is current. When nobody else holds the painter, its GL objects are freed.
    static void give_back(std::shared_ptr<Painter>& painter);

    // Whether of() would still return this painter for this capacity.
    bool is_current(std::uint64_t l1_bytes) const;

    FrameReport draw(const Camera& camera, const Vec3d& local_origin, const RenderOptions& options);

    // Repaints `view` when points have arrived; views may die at any time.
    void add_view(QWidget* view);

    // Of all clouds of the share group.
    L1Statistics statistics() const { return l1_->statistics(); }

    PointCloud& cloud() const { return *renderer_->cloud(); }

private:
    Painter(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1, const void* share_group);
    void wake_views();

    std::unique_ptr<CloudRenderer> renderer_;
    std::shared_ptr<L1Cache> l1_;
    const void* share_group_;
    std::vector<QPointer<QWidget>> views_;
};

}  // namespace pcm::host
