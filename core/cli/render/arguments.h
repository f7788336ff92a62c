// The command line of `pcmlab render`.
#pragma once

#include "pcm/cli/command_line.h"
#include "pcm/cli/common.h"
#include "pcm/gl/draw/renderer.h"
#include "pcm/ops/shared/camera_arguments.h"
#include "pcm/view/camera_path.h"

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcm::cli {

// As the window draws a view that rests.
inline RenderOptions smoothed()
{
    RenderOptions options;
    options.smooth_frames = usual_smooth_frames;
    return options;
}

struct RenderArguments {
    Common common;
    std::vector<std::string> trees;
    std::string output, size = "1280x720", splats = "fitted", colour = "rgb", uniform_colour, ramp = "auto", range,
                        background = "transparent", until = "full", path;
    std::vector<std::string> where, clips, clips_outside;
    ops::CameraArguments camera;
    ops::Arguments camera_arguments;  // bound to the camera
    std::optional<double> frame_budget_ms;
    bool overwrite = false, legend = false, discs = false;
    CloudStyle style;
    RenderOptions options = smoothed();
    std::uint64_t l1 = L1Options().capacity_bytes, l2 = L2Options().capacity_bytes;
    unsigned threads = 0;  // that load chunks; 0: one per processor
};
void add_to(Options& options, RenderArguments& arguments);

// What the arguments mean, before a tree is opened. Throws Error(invalid_argument).
ops::PictureSize size_of(const RenderArguments& arguments);
struct Background {
    bool transparent = false;
    std::array<float, 4> colour{};
};
Background background_of(const RenderArguments& arguments);
CloudStyle style_of(const RenderArguments& arguments);
std::vector<Clip> clips_of(const RenderArguments& arguments);
// Whether the trees have the attributes that the style names: the colour's in one of them, the conditions' in all.
// Throws Error(invalid_argument).
void check_attributes(const CloudStyle& style, const std::vector<std::shared_ptr<PointCloud>>& clouds);
// A note where the colour's name is that of an attribute as well; none else.
std::optional<std::string> other_meaning(const CloudStyle& style,
                                         const std::vector<std::shared_ptr<PointCloud>>& clouds);
RenderOptions options_of(const RenderArguments& arguments);

// The cameras, in source coordinates. Throws what CameraPath::read() throws and Error(invalid_argument).
std::vector<CameraFrame> cameras_of(const RenderArguments& arguments,
                                    const std::vector<std::shared_ptr<PointCloud>>& clouds, const Box3d& box,
                                    ops::PictureSize size);

// One file per picture: OUTPUT itself for a single one; NAME%04d.png with numbers from 1; FOLDER/0001.png, ... Throws
// Error(invalid_argument), and Error(exists) for an existing file without --overwrite.
std::vector<std::filesystem::path> files_of(const RenderArguments& arguments, std::size_t pictures);

}  // namespace pcm::cli
