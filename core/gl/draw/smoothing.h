// The picture of a resting view as the mean of frames at sub-pixel offsets (view/pixel_offset.h).
//
// When a view's picture is complete, it is the first of the frames. Each of the others is drawn as the picture was,
// within the frame budget and through L1, into PictureState::next, and then added to PictureState::sum, eye-dome
// lighting included; the mean of those that are complete is shown. When the view moves, all of that is dropped, and the
// sum is freed.
#pragma once

#include "pcm/gl/base/render_target.h"
#include "pcm/gl/draw/frame.h"

#include <cstdint>

namespace pcm {

// The number of frames for a picture of this number of points: at most `asked`; 1 where it is not worth it.
unsigned frames_worthwhile(unsigned asked, std::uint64_t points);

// Before the frame is drawn: sets Frame::again and, for it, Frame::offset. `resting`: the picture is that of the frame
// before.
void begin_smoothing(Frame& frame, bool resting);
// A frame of those, of a view for which begin_rest() has been called.
void draw_for_mean(Frame& frame);
// After the frame was drawn: adds it to the mean, or begins one, and completes the report.
void end_smoothing(Frame& frame, bool resting, Compositor& compositor, const Matrix4d& projection);
// How many frames are shown as their mean; 1: the picture itself.
unsigned frames_shown(const PictureState& picture);

}  // namespace pcm
