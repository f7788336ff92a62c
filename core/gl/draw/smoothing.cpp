#include "pcm/gl/draw/smoothing.h"

#include "pcm/gl/tuning.h"
#include "pcm/view/pixel_offset.h"

#include <algorithm>
#include <utility>

namespace pcm {
namespace {

// Nothing of it has been drawn.
PictureState::Rest from_the_start(const PictureState::Rest& complete)
{
    PictureState::Rest rest = complete;
    rest.added = 0;
    rest.left_out.clear();
    rest.points = rest.nodes = 0;
    std::fill(rest.points_of.begin(), rest.points_of.end(), 0);
    std::fill(rest.hidden_of.begin(), rest.hidden_of.end(), 0);
    rest.behind = true;
    return rest;
}

bool is_complete(const Frame& frame)
{
    const PictureState& p = frame.picture;
    const FrameReport& report = frame.report;
    return !report.refining && report.error.empty() && (!p.rest || !p.rest->begun || report.full_resolution);
}

// The picture that has become complete is the first frame.
void begin_mean(Frame& frame, Compositor& compositor, const Matrix4d& projection, unsigned goal)
{
    PictureState& p = frame.picture;
    PictureState::Smoothing& smoothing = p.smoothing.emplace();
    smoothing.asked = frame.options.smooth_frames;
    smoothing.finish = frame.finish(false);
    smoothing.frames = 1;
    if (!p.sum.begin(p.target.width(), p.target.height())) return;  // the picture is not changed
    smoothing.goal = goal;
    compositor.add(p.target, p.resolved, p.sum, projection, smoothing.finish);
}

}  // namespace

unsigned frames_worthwhile(unsigned asked, std::uint64_t points)
{
    const SmoothingTuning& tuned = gl_tuning().smoothing;
    const std::uint64_t affordable = tuned.max_points / std::max<std::uint64_t>(points, 1);
    const auto frames = static_cast<unsigned>(std::min<std::uint64_t>(affordable, std::min(asked, most_smooth_frames)));
    return frames < std::min<std::size_t>(asked, tuned.min_frames) ? 1 : std::max(frames, 1u);
}

void begin_smoothing(Frame& frame, bool resting)
{
    PictureState& p = frame.picture;
    auto& smoothing = p.smoothing;
    if (smoothing && (!resting || smoothing->asked != frame.options.smooth_frames ||
                      smoothing->finish.eye_dome != frame.options.eye_dome))
        smoothing.reset();
    if (!smoothing) p.sum.release();
    frame.again = smoothing && smoothing->frames < smoothing->goal;
    if (!frame.again) return;
    frame.offset = pixel_offset(smoothing->frames, smoothing->goal);
    frame.frame_of_mean = smoothing->frames;
}

void draw_for_mean(Frame& frame)
{
    PictureState& p = frame.picture;
    PictureState::Smoothing& smoothing = *p.smoothing;
    if (!smoothing.unfinished) {
        smoothing.unfinished = from_the_start(*p.rest);
        p.next.prepare(p.target.width(), p.target.height(), p.asked_samples);
        p.next.bind();
        p.next.clear();
    }
    bool possible = true;
    frame.drawn_again = draw_again(frame, *smoothing.unfinished, possible);
    if (!possible) smoothing.goal = smoothing.frames;
    if (!possible || frame.drawn_again) smoothing.unfinished.reset();
}

void end_smoothing(Frame& frame, bool resting, Compositor& compositor, const Matrix4d& projection)
{
    PictureState& p = frame.picture;
    FrameReport& report = frame.report;
    auto& smoothing = p.smoothing;
    const bool loads = report.refining && !report.repaint;
    if (frame.again && p.rest && p.rest->begun) {
        if (frame.drawn_again) {
            compositor.add(p.next, p.resolved, p.sum, projection, smoothing->finish);
            ++smoothing->frames;
        }
    } else if (frame.again) {
        // Chunks have arrived: the picture is not the same any more.
        if (!is_complete(frame)) {
            smoothing.reset();
            return;
        }
        compositor.add(p.next, p.resolved, p.sum, projection, smoothing->finish);
        ++smoothing->frames;
    } else if (!smoothing && is_complete(frame)) {
        const unsigned goal = frames_worthwhile(frame.options.smooth_frames, report.points_drawn);
        if (goal > 1 && resting) begin_mean(frame, compositor, projection, goal);
        report.smooth_frames = goal;
        report.smoothing = goal > 1 && !resting;
    }
    if (smoothing) {
        report.frames_averaged = smoothing->frames;
        report.smooth_frames = smoothing->goal;
        report.smoothing = smoothing->frames < smoothing->goal;
    }
    if (!report.smoothing) return;
    report.refining = true;
    report.repaint = !loads;
}

unsigned frames_shown(const PictureState& picture) { return picture.smoothing ? picture.smoothing->frames : 1; }

}  // namespace pcm
