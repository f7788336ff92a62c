// What `pcmlab render` is to draw, for the face that has OpenGL (Context::render).
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/gl/draw/renderer.h"
#include "pcm/ops/shared/camera_arguments.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm::ops {

// As the window draws a view that rests.
inline RenderOptions smoothed()
{
    RenderOptions options;
    options.smooth_frames = usual_smooth_frames;
    return options;
}

struct RenderRequest {
    std::vector<std::string> trees;  // drawn together
    std::string output;              // a picture; of a path, a folder or a name with a place for the number
    bool overwrite = false;
    CameraArguments camera;
    std::string path;  // a file with a camera for each picture, instead of the camera; empty: none
    std::string size = "1280x720", background = "transparent";
    // Colours as they are written: `colour` is a mode or an attribute; `range` is LOW:HIGH or empty; `uniform_colour`
    // is a colour that replaces all others, or empty.
    std::string colour = "rgb", range, uniform_colour;
    CloudStyle style;  // splats, their sizes, ramp, brightness and gamma; the rest follows from the colours and limits
    bool legend = false;
    Selection limits;  // conditions and clips of the points that are shown
    RenderOptions options = smoothed();
    std::optional<double> frame_budget_ms;  // absent: none
    std::string until = "full";             // or "target"
    std::uint64_t l1 = L1Options().capacity_bytes, l2 = L2Options().capacity_bytes;
    std::uint32_t threads = 0;  // number of threads that load chunks; 0: one per processor
};

}  // namespace pcm::ops
