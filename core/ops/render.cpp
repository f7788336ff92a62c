// Trees drawn to pictures. What draws them is Context::render: it needs OpenGL, which this library does not use.
#include "pcm/gl/style/colour_modes.h"
#include "pcm/gl/style/splat_modes.h"
#include "pcm/ops/render_request.h"
#include "pcm/ops/shared/region_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/error.h"
#include "pcm/view/colour_ramps.h"

namespace pcm::ops {
namespace {

// The rows of splat_modes() or colour_ramps(), which are in the order of their enumerators.
template <class Table>
std::vector<Choice> choices_of(const Table& rows)
{
    std::vector<Choice> choices;
    for (const auto& row : rows) choices.push_back({row.name, row.label});
    return choices;
}

std::string names_of_colours()
{
    std::string names;
    for (const ColourTraits& traits : colour_modes())
        if (traits.mode != ColourMode::attribute) names += std::string(traits.name) + ", ";
    return names;
}

class Render : public Operation {
public:
    Render()
    {
        arguments_.add("trees", request_.trees)
            .as(ValueKind::trees)
            .positional()
            .required()
            .help("Tree folders, or any files of them, which are rendered together");
        arguments_.add("output", request_.output)
            .as(ValueKind::output)
            .letter('o')
            .required()
            .help(
                "Picture: .png, or .npy, which is an array for NumPy; with --path, a folder or a name with a place for "
                "the "
                "number, such as tour%04d.png");
        arguments_.add("overwrite", request_.overwrite).help("Replace existing pictures");
        declare_camera();
        declare_splats();
        declare_colours();
        limits_.declare_limits(arguments_, look);
        declare_picture();
        declare_detail();
        arguments_.add("threads", request_.threads)
            .advanced()
            .letter('t')
            .between(1, 256)
            .help("Number of threads that load chunks")
            .automatic("one per processor");
    }

    Result answer(const Context& context) override
    {
        if (discs_ && arguments_.given("splats"))
            throw ArgumentError("--discs and --splats were both given: give one of them");
        if (!request_.path.empty() && request_.camera.given())
            throw ArgumentError(
                "--path has a camera for each picture: leave out --eye, --target, --up, --angle, "
                "--orthographic and --height");
        if (!context.render)
            throw Error(ErrorCode::invalid_argument, {}, "no pictures can be drawn here", "use the command pcmlab");
        if (discs_) request_.style.splats = SplatMode::perspective;
        request_.limits = limits_.get();
        return context.render(request_);
    }

private:
    static constexpr const char* look = "Appearance";

    void declare_camera()
    {
        const char* const group =
            "Camera (default: where the scan was taken from, where that is known, else an oblique view of everything)";
        request_.camera.declare(arguments_, group);
        arguments_.add("path", request_.path)
            .as(ValueKind::file)
            .group(group)
            .label("Camera path")
            .help("Camera path (.json): one picture per frame; not with the other options of the camera");
    }

    void declare_splats()
    {
        arguments_.add("size", request_.size)
            .group(look)
            .label("Size of the picture")
            .help("Width and height of the picture, pixels: --size 1920x1080");
        arguments_.choice("splats", request_.style.splats, choices_of(splat_modes()))
            .group(look)
            .help("What points are drawn as; not with --discs");
        arguments_.add("discs", discs_)
            .advanced()
            .group(look)
            .help(
                "Points with normals and radii are drawn as their discs, each pixel at its own depth: as --splats "
                "perspective, and not with it");
        arguments_.add("point_size", request_.style.point_size_px)
            .between(0.1, 1000)
            .unit("pixels")
            .group(look)
            .help("Constant splats: side of the square");
        arguments_.add("radius_scale", request_.style.radius_scale)
            .advanced()
            .between(1e-6, 1e6)
            .group(look)
            .label("Factor on radii")
            .help("Other splats: factor on the radii");
    }

    void declare_colours()
    {
        arguments_.add("colour", request_.colour)
            .also("color")
            .group(look)
            .help("What the colours show: " + names_of_colours() +
                  "or an attribute by its name, such as gps_time or normal[2]; in quotes, \"'height'\", where the name "
                  "is one of these");
        arguments_.choice("ramp", request_.style.ramp, choices_of(colour_ramps()))
            .group(look)
            .label("Colour ramp")
            .help("Colours of values: of the intensity, the height or an attribute");
        arguments_.add("range", request_.range)
            .group(look)
            .label("Range of the ramp")
            .help("LOW:HIGH, the values at the ramp's ends: --range 0:250")
            .without("those between which 98 % of the cloud's points lie");
        arguments_.add("legend", request_.legend)
            .group(look)
            .help("Write into the picture what its colours mean: values of the ramp, or classes");
        arguments_.add("uniform_colour", request_.uniform_colour)
            .advanced()
            .also("uniform-color")
            .group(look)
            .help("One colour for all points, #rrggbb or R,G,B: --uniform-colour 255,128,0");
        arguments_.add("brightness", request_.style.brightness)
            .advanced()
            .between(0.01, 100)
            .group(look)
            .help("Factor on the clouds' own colours (--colour rgb), for dark scans, such as 1.5");
        arguments_.add("gamma", request_.style.gamma)
            .advanced()
            .between(0.1, 10)
            .group(look)
            .help(
                "After that, colours from 0 to 1 are raised to 1 / gamma: above 1 makes dark ones lighter, such as "
                "1.8");
    }

    void declare_picture()
    {
        RenderOptions& options = request_.options;
        arguments_.add("samples", options.samples)
            .advanced()
            .between(1, 8)
            .group(look)
            .label("Samples per pixel")
            .help("Samples per pixel, which smooth edges: --samples 4");
        arguments_.add("converge", options.smooth_frames)
            .advanced()
            .between(1, most_smooth_frames)
            .group(look)
            .label("Frames of the mean")
            .help(
                "Maximum number of frames, at sub-pixel offsets, whose mean is the picture: edges and far textures "
                "without stairs and speckles. Fewer where all frames together would draw more than 200 M points; 1: "
                "one frame, the fastest");
        arguments_.add("eye_dome", options.eye_dome)
            .between(0, 100)
            .group(look)
            .label("Eye-dome lighting")
            .help("Strength of eye-dome lighting, which shows relief without normals; 1 is usual");
        arguments_.add("background", request_.background)
            .group(look)
            .help("transparent, black, white, #rrggbb or R,G,B: --background 30,30,30");
    }

    void declare_detail()
    {
        const char* const group = "Level of detail";
        arguments_.add("until", request_.until)
            .advanced()
            .as(ValueKind::choice)
            .one_of({{"full", "Every point in view"}, {"target", "The target"}})
            .group(group)
            .label("Draw until")
            .help(
                "full: every point in view; target: until --target-px is reached, or as many points as the budgets "
                "allow in a frame");
        arguments_.add("target_px", request_.options.target_spacing_px)
            .advanced()
            .between(0.01, 1e6)
            .unit("pixels")
            .group(group)
            .label("Target spacing")
            .help("Largest distance between points on screen");
        arguments_.add("frame_budget", request_.frame_budget_ms)
            .advanced()
            .positive()
            .unit("milliseconds")
            .group(group)
            .help("Time limit per frame")
            .without("none");
        arguments_.add("point_budget", request_.options.point_budget)
            .advanced()
            .positive()
            .group(group)
            .help("Maximum number of points per frame");
        arguments_.add("l1", request_.l1)
            .advanced()
            .as(ValueKind::bytes)
            .group(group)
            .label("Video memory")
            .help("Video memory for chunks, at least 1M, such as 256M");
        arguments_.add("l2", request_.l2)
            .advanced()
            .as(ValueKind::bytes)
            .group(group)
            .label("Memory")
            .help("Memory for chunks, per tree, such as 1G");
    }

    RenderRequest request_;
    RegionArguments limits_;
    bool discs_ = false;
};

}  // namespace

Row render_row()
{
    return {"render",
            nullptr,
            "Render trees to pictures, from a camera or along a camera path, without a window",
            "Draws trees together, as MeshLab's window shows a view that rests: every point in view, or as many as "
            "budgets allow. One picture from a camera, or one for each frame of a camera path. Takes OpenGL 3.3, in "
            "software too, and no display.",
            0,
            nullptr,
            {{"trees", "list", "", "the trees, as in input"},
             {"width", "count", "pixels", "width of each picture"},
             {"height", "count", "pixels", "height of each picture"},
             {"drawn_with", "text", "", "renderer of the OpenGL driver"},
             {"pictures", "list", "",
              "for each: file, points_drawn, clouds, screen_error_px, full_resolution, pixels, ms, frames, "
              "frames_averaged, uploaded_bytes, nodes_drawn, programs (shader programs built so far)"},
             {"reads", "list", "",
              "for each tree: attributes (stored), columns (decoded), nodes, chunks (read), points, bytes (read), "
              "bytes_of_tree"}},
            make<Render>,
            {},
            "Its time limit is that of a frame, --frame-budget, and its error target a distance on the screen, "
            "--target-px."};
}

}  // namespace pcm::ops
