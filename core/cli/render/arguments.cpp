#include "pcm/cli/render/arguments.h"

#include "pcm/cloud/attribute_names.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <limits>

namespace pcm::cli {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& what, const std::string& hint = {})
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

// The names of a table: splat_modes(), colour_modes() or colour_ramps().
template <class Table>
std::vector<std::string> names_of(const Table& modes)
{
    std::vector<std::string> names;
    for (const auto& row : modes) names.emplace_back(row.name);
    return names;
}

// `name` is one of them.
template <class Table>
auto find_named(const std::string& name, const Table& rows)
{
    return std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return name == row.name; });
}
template <class Table>
auto mode_of(const std::string& name, const Table& modes)
{
    return find_named(name, modes)->mode;
}

std::string listed(const std::vector<std::string>& names)
{
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

// #rrggbb, or three numbers from 0 to 255.
std::array<float, 3> colour_of(const std::string& text, const char* option)
{
    unsigned c[3];
    int end = 0;
    const bool hex =
        std::sscanf(text.c_str(), "#%2x%2x%2x%n", &c[0], &c[1], &c[2], &end) == 3 && text.size() == 7 && end == 7;
    if (!hex) {
        end = 0;
        if (std::sscanf(text.c_str(), "%3u,%3u,%3u%n", &c[0], &c[1], &c[2], &end) != 3 ||
            static_cast<std::size_t>(end) != text.size() || std::max({c[0], c[1], c[2]}) > 255)
            refuse(std::string(option) + " '" + text + "' is not a colour",
                   "write #rrggbb, or three numbers from 0 to 255 as in 255,128,0");
    }
    return {static_cast<float>(c[0]) / 255, static_cast<float>(c[1]) / 255, static_cast<float>(c[2]) / 255};
}

// The place for a number in a name such as NAME%04d.png: its begin, its end and the least number of digits.
struct Pattern {
    std::size_t begin = 0, end = 0;
    int digits = 0;
};
std::optional<Pattern> pattern_of(const std::string& name)
{
    Pattern found;
    found.begin = name.find('%');
    if (found.begin == std::string::npos) return {};
    std::size_t at = found.begin + 1;
    while (at < name.size() && name[at] >= '0' && name[at] <= '9' && at - found.begin < 4)
        found.digits = found.digits * 10 + (name[at++] - '0');
    if (at >= name.size() || name[at] != 'd' || name.find('%', at) != std::string::npos || found.digits > 20)
        refuse("the % in the output '" + name + "' is not a place for a number", "write it as in picture%04d.png");
    found.end = at + 1;
    return found;
}

std::string numbered(std::size_t number, int digits)
{
    std::string text = std::to_string(number);
    if (text.size() < static_cast<std::size_t>(digits))
        text.insert(0, static_cast<std::size_t>(digits) - text.size(), '0');
    return text;
}

void require_png(const fs::path& file)
{
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension != ".png")
        throw Error(ErrorCode::invalid_argument, file, "pictures are written as PNG only",
                    "end the output's name with .png");
}

void add_camera(Options& options, RenderArguments& a)
{
    const char* const group =
        "Camera (default: where the scan was taken from, where that is known, else an oblique view of everything)";
    a.camera.declare(a.camera_arguments, group);
    std::vector<Option> of_one_view;
    for (ops::Argument& argument : a.camera_arguments.list()) of_one_view.push_back(options.argument(argument));
    const Option path = options.option("--path", a.path, "Camera path (.json): one picture per frame").group(group);
    for (const Option& option : of_one_view) path.excludes(option);
}

void add_clips(Options& options, RenderArguments& a, const char* group)
{
    options
        .option("--clip", a.clips,
                "Show only points in this region, such as \"box 0 0 0 9 9 9\" or \"sphere 1 2 3 0.5\"; of several "
                "clips, all must hold")
        .one_value_each()
        .group(group);
    options.option("--clip-outside", a.clips_outside, "Show only points that are not in this region; repeatable")
        .one_value_each()
        .group(group);
}

void add_tone(Options& options, RenderArguments& a, const char* group)
{
    options
        .option("--brightness", a.style.brightness,
                "Factor on the clouds' own colours (--colour rgb), for dark scans, such as 1.5")
        .show_default()
        .between(0.01, 100.0)
        .group(group);
    options
        .option("--gamma", a.style.gamma,
                "After that, colours from 0 to 1 are raised to 1 / gamma: above 1 makes dark ones lighter, such as 1.8")
        .show_default()
        .between(0.1, 10.0)
        .group(group);
}

void add_splats(Options& options, RenderArguments& a, const char* group)
{
    options.option("--point-size", a.style.point_size_px, "Constant splats: side in pixels")
        .show_default()
        .between(0.1, 1000.0)
        .group(group);
    options.option("--radius-scale", a.style.radius_scale, "Other splats: factor on the radii")
        .show_default()
        .between(1e-6, 1e6)
        .group(group);
    options.option("--samples", a.options.samples, "Samples per pixel, which smooth edges: --samples 4")
        .show_default()
        .between(1, 8)
        .group(group);
    options
        .option("--converge", a.options.smooth_frames,
                "The picture is the mean of so many frames at sub-pixel offsets, or of fewer where there are more than "
                "200 M points in all of them: edges and far textures without stairs and speckles; 1: one frame, the "
                "fastest")
        .show_default()
        .between(1, static_cast<int>(most_smooth_frames))
        .group(group);
    options
        .option("--eye-dome", a.options.eye_dome,
                "Strength of eye-dome lighting, which shows relief without normals; 1 is usual")
        .show_default()
        .between(0.0, 100.0)
        .group(group);
}

void add_look(Options& options, RenderArguments& a)
{
    const char* const group = "Appearance";
    options.option("--size", a.size, "Width and height of the picture, pixels: --size 1920x1080")
        .show_default()
        .group(group);
    const Option splats =
        options.option("--splats", a.splats, "What points are drawn as: " + listed(names_of(splat_modes())))
            .show_default()
            .one_of(names_of(splat_modes()))
            .group(group);
    options
        .flag(
            "--discs", a.discs,
            "Points with normals and radii are drawn as their discs, each pixel at its own depth: --splats perspective")
        .group(group)
        .excludes(splats);
    options
        .option(
            "--colour,--color", a.colour,
            "By what they are coloured: " + listed(names_of(colour_modes())) +
                " by its name, such as gps_time or normal[2]; in quotes, \"'height'\", where the name is one of these")
        .show_default()
        .group(group);
    options
        .option("--ramp", a.ramp,
                "Colours of values (intensity, height, an attribute): " + listed(names_of(colour_ramps())))
        .show_default()
        .one_of(names_of(colour_ramps()))
        .group(group);
    options
        .option("--range", a.range,
                "LOW:HIGH, the values at the ramp's ends: --range 0:250 (default: those between which 98 % of the "
                "cloud's points lie)")
        .group(group);
    options.flag("--legend", a.legend, "Write into the picture what its colours mean: values of the ramp, or classes")
        .group(group);
    options
        .option(
            "--where", a.where,
            "Show only points that satisfy a condition, such as classification=2,6 or \"intensity>=100\" or z=100..; "
            "of several conditions, all")
        .one_value_each()
        .group(group);
    add_clips(options, a, group);
    options
        .option("--uniform-colour,--uniform-color", a.uniform_colour,
                "One colour for all points, #rrggbb or R,G,B: --uniform-colour 255,128,0")
        .group(group);
    add_tone(options, a, group);
    add_splats(options, a, group);
    options.option("--background", a.background, "transparent, black, white, #rrggbb or R,G,B: --background 30,30,30")
        .show_default()
        .group(group);
}

void add_amount(Options& options, RenderArguments& a)
{
    const char* const group = "Level of detail";
    options
        .option("--until", a.until,
                "full: every point in view; target: until --target-px is reached, or as many points as the budgets "
                "allow in a frame")
        .show_default()
        .one_of({"full", "target"})
        .group(group);
    options.option("--target-px", a.options.target_spacing_px, "Largest distance between points on screen, pixels")
        .show_default()
        .between(0.01, 1e6)
        .group(group);
    options.option("--frame-budget", a.frame_budget_ms, "Time limit per frame, milliseconds (default: none)")
        .positive()
        .group(group);
    options.option("--point-budget", a.options.point_budget, "Maximum number of points per frame")
        .show_default()
        .positive()
        .group(group);
    options.option("--l1", a.l1, "Video memory for chunks, at least 1M, e.g. 256M (default 512M)").bytes().group(group);
    options.option("--l2", a.l2, "Memory for chunks, per tree, e.g. 1G (default 512M)").bytes().group(group);
}

}  // namespace

void add_to(Options& options, RenderArguments& a)
{
    options.positional("trees", a.trees, "Trees, rendered together").required();
    options
        .option("-o,--output", a.output,
                "PNG file; with --path, a folder or a name with a place for the number, such as tour%04d.png")
        .required();
    options.flag("--overwrite", a.overwrite, "Replace existing pictures");
    add_camera(options, a);
    add_look(options, a);
    add_amount(options, a);
    options.option("-t,--threads", a.threads, "Loading threads (default: one per processor)").between(1, 256);
    add_common(options, a.common);
}

ops::PictureSize size_of(const RenderArguments& arguments) { return ops::parse_size(arguments.size); }

Background background_of(const RenderArguments& arguments)
{
    if (arguments.background == "transparent") return {true, {0, 0, 0, 0}};
    if (arguments.background == "black") return {false, {0, 0, 0, 1}};
    if (arguments.background == "white") return {false, {1, 1, 1, 1}};
    const std::array<float, 3> c = colour_of(arguments.background, "--background");
    return {false, {c[0], c[1], c[2], 1}};
}

CloudStyle style_of(const RenderArguments& arguments)
{
    CloudStyle style = arguments.style;
    style.splats = arguments.discs ? SplatMode::perspective : mode_of(arguments.splats, splat_modes());
    const std::vector<std::string> modes = names_of(colour_modes());
    const auto written = written_name(arguments.colour, "");
    if (!written) refuse("--colour " + arguments.colour + ": the quotes around the attribute's name do not match");
    const bool is_mode = !written->quoted && std::find(modes.begin(), modes.end(), written->name) != modes.end();
    style.colour = is_mode ? mode_of(written->name, colour_modes()) : ColourMode::attribute;
    style.attribute = written->name;
    style.ramp = find_named(arguments.ramp, colour_ramps())->ramp;
    if (!arguments.range.empty()) {
        if (!has_range(style.colour) || !arguments.uniform_colour.empty())
            refuse("--range says which values a colour ramp shows, and --colour " + arguments.colour + " shows none",
                   "give --colour height, intensity or an attribute's name");
        style.range = parse_value_range(arguments.range);
    }
    for (const std::string& condition : arguments.where) style.where.push_back(parse_condition(condition));
    if (!arguments.uniform_colour.empty()) {
        style.colour = ColourMode::uniform;
        style.uniform_colour = colour_of(arguments.uniform_colour, "--uniform-colour");
    }
    if (style.colour != ColourMode::rgb && (style.brightness != 1 || style.gamma != 1))
        refuse("--brightness and --gamma are for the clouds' own colours, which this picture does not show",
               "leave them out, or give --colour rgb");
    return style;
}

std::vector<Clip> clips_of(const RenderArguments& arguments)
{
    std::vector<Clip> clips;
    for (const std::string& text : arguments.clips) clips.push_back({parse_region(text), false});
    for (const std::string& text : arguments.clips_outside) clips.push_back({parse_region(text), true});
    return clips;
}

void check_attributes(const CloudStyle& style, const std::vector<std::shared_ptr<PointCloud>>& clouds)
{
    Selection selection;
    selection.where = style.where;
    bool any = style.colour != ColourMode::attribute;
    std::vector<std::string> names;
    for (const auto& cloud : clouds) {
        const Schema& schema = cloud->info().schema;
        try {
            const Selector test(selection, schema);
        } catch (const Error& error) {
            throw Error(ErrorCode::invalid_argument, cloud->tree()->folder(), error.what());
        }
        any = any || place_of(schema, style.attribute);
        for (const std::string& name : component_names(schema))
            if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    if (any) return;
    std::vector<std::string> modes = names_of(colour_modes());
    modes.erase(std::remove(modes.begin(), modes.end(), "attribute"), modes.end());
    refuse("--colour '" + style.attribute + "' is neither a way to colour points nor an attribute of the cloud",
           "give one of " + listed(modes) + (names.empty() ? "" : ", or an attribute: " + listed(names)));
}

std::optional<std::string> other_meaning(const CloudStyle& style,
                                         const std::vector<std::shared_ptr<PointCloud>>& clouds)
{
    const std::string name = name_of(style.colour);
    const bool reads_it = style.colour == ColourMode::attribute || style.colour == ColourMode::rgb ||
                          style.colour == ColourMode::intensity || style.colour == ColourMode::classification;
    if (!reads_it)
        for (const auto& cloud : clouds)
            if (cloud->info().schema.find(name))
                return "the cloud has an attribute '" + name + "' too: --colour \"'" + name + "'\" shows it";
    return std::nullopt;
}

RenderOptions options_of(const RenderArguments& arguments)
{
    RenderOptions options = arguments.options;
    options.converge = options.paraboloids = arguments.until == "full";
    // Nobody looks at single frames here. They end so that Ctrl-C is noticed, and so that the lists of chunks to load,
    // which each frame makes, stay up to date.
    options.upload_budget_ms = 50;
    options.frame_budget_ms = arguments.frame_budget_ms ? *arguments.frame_budget_ms
                              : options.converge        ? 250
                                                        : std::numeric_limits<double>::infinity();
    options.prefetch_frames = 0;
    return options;
}

std::vector<CameraFrame> cameras_of(const RenderArguments& arguments,
                                    const std::vector<std::shared_ptr<PointCloud>>& clouds, const Box3d& box,
                                    ops::PictureSize size)
{
    if (!arguments.path.empty()) return CameraPath::read(arguments.path).placed(box).frames;
    return {arguments.camera.frame(clouds, box, size)};
}

std::vector<fs::path> files_of(const RenderArguments& arguments, std::size_t pictures)
{
    const std::string& output = arguments.output;
    const fs::path as_path = output;
    std::vector<fs::path> files;
    std::error_code ignored;
    if (const auto pattern = pattern_of(output)) {
        require_png(as_path);
        for (std::size_t i = 1; i <= pictures; ++i)
            files.emplace_back(output.substr(0, pattern->begin) + numbered(i, pattern->digits) +
                               output.substr(pattern->end));
    } else if (arguments.path.empty()) {
        require_png(as_path);
        files.push_back(as_path);
    } else if (as_path.has_extension() && !fs::is_directory(as_path, ignored)) {
        throw Error(ErrorCode::invalid_argument, as_path,
                    "the " + std::to_string(pictures) + " pictures of a path need a file each",
                    "give a folder, or a name with a place for the number, as in picture%04d.png");
    } else {
        const int digits = std::max(4, static_cast<int>(std::to_string(pictures).size()));
        for (std::size_t i = 1; i <= pictures; ++i) files.push_back(as_path / (numbered(i, digits) + ".png"));
    }
    for (const fs::path& file : files)
        if (fs::exists(output_file(file), ignored) && !arguments.overwrite)
            throw Error(ErrorCode::exists, file, "the output already exists",
                        "choose another name, or give --overwrite");
    return files;
}

}  // namespace pcm::cli
