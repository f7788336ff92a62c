#include "pcm/cli/render/request.h"

#include "pcm/cloud/attribute_names.h"
#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "pcm/system/output_path.h"

#include <algorithm>
#include <cstdio>
#include <limits>

namespace pcm::cli {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& what, const std::string& hint = {})
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

std::vector<std::string> names_of_colours()
{
    std::vector<std::string> names;
    for (const ColourTraits& traits : colour_modes()) names.emplace_back(traits.name);
    return names;
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

// The place for a number in a name such as NAME%04d.png: its begin, its end and the minimum number of digits.
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

void require_picture(const fs::path& file)
{
    const std::string extension = lower_extension(file);
    if (extension != ".png" && extension != ".npy")
        throw Error(ErrorCode::invalid_argument, file, "pictures are written as PNG, or as an array of NumPy",
                    "end the output's name with .png or .npy");
}

}  // namespace

void write_picture(const fs::path& file, const Image& image, const Background& background)
{
    (lower_extension(file) == ".npy" ? write_npy : write_png)(file, image, background.transparent);
}

Background background_of(const ops::RenderRequest& request)
{
    if (request.background == "transparent") return {true, {0, 0, 0, 0}};
    if (request.background == "black") return {false, {0, 0, 0, 1}};
    if (request.background == "white") return {false, {1, 1, 1, 1}};
    const std::array<float, 3> c = colour_of(request.background, "--background");
    return {false, {c[0], c[1], c[2], 1}};
}

CloudStyle style_of(const ops::RenderRequest& request)
{
    CloudStyle style = request.style;
    const auto written = written_name(request.colour, "");
    if (!written) refuse("--colour " + request.colour + ": the quotes around the attribute's name do not match");
    const auto& modes = colour_modes();
    const auto mode = std::find_if(modes.begin(), modes.end(),
                                   [&](const ColourTraits& traits) { return written->name == traits.name; });
    style.colour = !written->quoted && mode != modes.end() ? mode->mode : ColourMode::attribute;
    style.attribute = written->name;
    if (!request.range.empty()) {
        if (!has_range(style.colour) || !request.uniform_colour.empty())
            refuse("--range says which values a colour ramp shows, and --colour " + request.colour + " shows none",
                   "give --colour height, intensity or an attribute's name");
        style.range = parse_value_range(request.range);
    }
    style.where = request.limits.where;
    if (!request.uniform_colour.empty()) {
        style.colour = ColourMode::uniform;
        style.uniform_colour = colour_of(request.uniform_colour, "--uniform-colour");
    }
    if (style.colour != ColourMode::rgb && (style.brightness != 1 || style.gamma != 1))
        refuse("--brightness and --gamma are for the clouds' own colours, which this picture does not show",
               "leave them out, or give --colour rgb");
    return style;
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
    std::vector<std::string> modes = names_of_colours();
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

RenderOptions options_of(const ops::RenderRequest& request)
{
    RenderOptions options = request.options;
    options.converge = options.paraboloids = request.until == "full";
    // Nobody looks at single frames here. They end so that Ctrl-C is noticed, and so that the lists of chunks to load,
    // which each frame makes, stay up to date.
    options.upload_budget_ms = 50;
    options.frame_budget_ms = request.frame_budget_ms ? *request.frame_budget_ms
                              : options.converge      ? 250
                                                      : std::numeric_limits<double>::infinity();
    options.prefetch_frames = 0;
    return options;
}

std::vector<CameraFrame> cameras_of(const ops::RenderRequest& request,
                                    const std::vector<std::shared_ptr<PointCloud>>& clouds, const Box3d& box,
                                    ops::PictureSize size)
{
    if (!request.path.empty()) return CameraPath::read(request.path).placed(box).frames;
    return {request.camera.frame(clouds, box, size)};
}

std::vector<fs::path> files_of(const ops::RenderRequest& request, std::size_t pictures)
{
    const std::string& output = request.output;
    const fs::path as_path = output;
    std::vector<fs::path> files;
    std::error_code ignored;
    if (const auto pattern = pattern_of(output)) {
        require_picture(as_path);
        for (std::size_t i = 1; i <= pictures; ++i)
            files.emplace_back(output.substr(0, pattern->begin) + numbered(i, pattern->digits) +
                               output.substr(pattern->end));
    } else if (request.path.empty()) {
        require_picture(as_path);
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
        if (fs::exists(output_file(file), ignored) && !request.overwrite)
            throw Error(ErrorCode::exists, file, "the output already exists",
                        "choose another name, or give --overwrite");
    return files;
}

}  // namespace pcm::cli
