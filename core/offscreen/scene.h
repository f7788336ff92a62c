// Trees that are drawn together without a window. `pcmlab render`, benchmarks and tests use it; the renderer is the one
// that draws in MeshLab.
//
//     pcm::Offscreen screen(640, 480);
//     pcm::OffscreenScene scene({"city.pct"});
//     const pcm::Camera view = scene.view_of(pcm::overview_of(scene.box(), 45, 640, 480), 640, 480);
//     pcm::FrameReport report;
//     do {
//         screen.clear();
//         report = scene.draw(view, {}, {});
//         if (report.refining && !report.repaint) scene.wait();
//     } while (report.refining);
//     pcm::write_png("city.png", screen.read());
//
// GL thread only. The caller provides the framebuffer, and the context that must be current during its lifetime.
#pragma once

#include "pcm/gl/draw/renderer.h"
#include "pcm/view/camera_path.h"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace pcm {

class OffscreenScene {
public:
    // `l2` is the capacity of each cloud's L2. Throws what PointCloud::open() throws, and Error(invalid_argument) for
    // no tree, a tree named twice, or nothing but empty ones.
    explicit OffscreenScene(const std::vector<std::filesystem::path>& trees, const L1Options& l1 = {},
                            const L2Options& l2 = {});
    ~OffscreenScene();
    OffscreenScene(const OffscreenScene&) = delete;
    OffscreenScene& operator=(const OffscreenScene&) = delete;

    const Box3d& box() const { return box_; }  // of all clouds
    const std::vector<std::shared_ptr<PointCloud>>& clouds() const { return clouds_; }
    Camera view_of(const CameraFrame& frame, int width, int height) const
    {
        return pcm::view_of(frame, origin_, box_, width, height);
    }

    // Only points that all of these leave are drawn from now on.
    void clip(std::vector<Clip> clips) { clips_ = std::move(clips); }

    // One frame into the current framebuffer and viewport, whose size is the view's; all clouds in the same style.
    FrameReport draw(const Camera& view, const CloudStyle& style, const RenderOptions& options);
    // Waits until a chunk has arrived since the last draw(), at most `most`.
    void wait(std::chrono::milliseconds most = std::chrono::milliseconds(250));
    // The next frame starts from an empty picture.
    void forget() { picture_.invalidate(); }

    L1Statistics l1_statistics() const { return l1_->statistics(); }
    std::uint64_t loaded_bytes() const;  // into L2, of all clouds

private:
    std::vector<std::shared_ptr<PointCloud>> clouds_;
    std::shared_ptr<L1Cache> l1_;
    std::vector<std::unique_ptr<DrawnCloud>> drawn_;
    Renderer renderer_;
    Picture picture_;
    std::vector<Clip> clips_;
    Box3d box_;
    Vec3d origin_{};
    std::mutex mutex_;  // of arrived_
    std::condition_variable arrival_;
    bool arrived_ = false;
};

}  // namespace pcm
