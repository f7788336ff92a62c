// The renderer, L1 cache and clouds of a GL share group.
//
// The views of a MeshLab project share buffers and programs, so they share a renderer, an L1 and the clouds in it; two
// projects share nothing. GUI thread only, except that loader threads wake the views.
#pragma once

#include "pcm/gl/draw/renderer.h"

#include <QObject>
#include <QPointer>
#include <QWidget>

#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace pcm::host {

class PaintedCloud;

// One per share group.
class Painter {
public:
    // The painter of the current context's share group, with an L1 of this capacity. If the capacity has changed, a new
    // painter is made; views that hold the former one may still draw with it, or give it back.
    static std::shared_ptr<Painter> current(std::uint64_t l1_bytes);
    // A context of the share group must be current. Frees the GL objects if this is the last reference.
    static void give_back(std::shared_ptr<Painter>& painter);

    Renderer& renderer() { return renderer_; }
    L1Statistics statistics() const { return renderer_.l1()->statistics(); }

    Painter(const Painter&) = delete;
    Painter& operator=(const Painter&) = delete;

private:
    friend class PaintedCloud;
    explicit Painter(std::shared_ptr<L1Cache> l1) : renderer_(std::move(l1)) {}

    Renderer renderer_;
    std::map<std::pair<const PointCloud*, int>, std::weak_ptr<PaintedCloud>> clouds_;
};

// A layer's cloud in a share group, for all views. Two layers may show the same tree, and a picture can contain a cloud
// only once; so there is one per layer, not one per tree.
class PaintedCloud : public QObject {
    Q_OBJECT

public:
    static std::shared_ptr<PaintedCloud> of(const std::shared_ptr<PointCloud>& cloud, int layer_id,
                                            const std::shared_ptr<Painter>& painter);
    ~PaintedCloud() override;
    // As Painter::give_back.
    static void give_back(std::shared_ptr<PaintedCloud>& cloud);

    DrawnCloud& drawn() { return *drawn_; }
    PointCloud& cloud() const { return *drawn_->cloud(); }

    // Repaints `view` when points have arrived. Views may be destroyed at any time.
    void add_view(QWidget* view);

private:
    PaintedCloud(const std::shared_ptr<PointCloud>& cloud, const std::shared_ptr<Painter>& painter);
    void wake_views();

    std::shared_ptr<Painter> painter_;
    std::unique_ptr<DrawnCloud> drawn_;
    std::vector<QPointer<QWidget>> views_;
};

}  // namespace pcm::host
