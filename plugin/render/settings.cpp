#include "render/settings.h"

#include <algorithm>

namespace pcm::host {

namespace {

const char* const splat_size = "MeshLab::PointCloud::SplatSize";
const char* const colour = "MeshLab::PointCloud::Colour";
const char* const target_spacing = "MeshLab::PointCloud::TargetSpacing";
const char* const frame_budget = "MeshLab::PointCloud::FrameBudget";
const char* const rest_budget = "MeshLab::PointCloud::RestBudget";
const char* const point_budget = "MeshLab::PointCloud::PointBudget";
const char* const upload_budget = "MeshLab::PointCloud::UploadBudget";
const char* const l1_size = "MeshLab::PointCloud::VideoMemory";
const char* const l2_size = "MeshLab::PointCloud::Memory";

std::uint64_t mebibytes(const RichParameterList& parameters, const char* name, int least)
{
    return static_cast<std::uint64_t>(std::clamp(parameters.getInt(name), least, 1 << 24)) << 20;
}

}  // namespace

void add_settings(RichParameterList& parameters)
{
    const RenderOptions d;
    parameters.addParam(RichFloat(splat_size, d.point_size_px, "Splat size (px)",
                                  "Side of the square that a point is drawn as, in pixels. Default 2."));
    parameters.addParam(
        RichEnum(colour, 0,
                 QStringList() << "Colour"
                               << "Intensity"
                               << "Height"
                               << "Uniform",
                 "Colour by",
                 "What the colour of a point shows. A cloud without colours shows its intensity, and one "
                 "without that its height. Default Colour."));
    parameters.addParam(
        RichFloat(target_spacing, static_cast<float>(d.target_spacing_px), "Target spacing (px)",
                  "Detail is added until points are no farther apart than this on the screen, in pixels. "
                  "Default 1.4."));
    parameters.addParam(RichFloat(frame_budget, static_cast<float>(d.frame_budget_ms), "Frame budget (ms)",
                                  "Time that drawing may take while the view moves, in milliseconds; fewer points are "
                                  "drawn when all would take longer. Default 33."));
    parameters.addParam(RichFloat(rest_budget, static_cast<float>(d.rest_budget_ms), "Still picture budget (ms)",
                                  "The same for a view that rests, in milliseconds. Default 250."));
    parameters.addParam(RichFloat(point_budget, static_cast<float>(d.point_budget / 1e6), "Point budget (millions)",
                                  "Never draw more points than this, in millions. Default 20."));
    parameters.addParam(RichInt(l1_size, static_cast<int>(L1Options().capacity_bytes >> 20), "Video memory (MB)",
                                "Memory on the graphics card for the points of all layers of a project, in megabytes. "
                                "Default 512."));
    parameters.addParam(
        RichInt(l2_size, static_cast<int>(L2Options().capacity_bytes >> 20), "Memory (MB)",
                "Main memory for the points of each cloud, in megabytes; what does not fit is read from "
                "disk again. Default 512."));
    parameters.addParam(RichFloat(upload_budget, static_cast<float>(d.upload_budget_ms), "Upload budget (ms)",
                                  "Time in each frame for bringing new points to the graphics card, in milliseconds. "
                                  "Default 3."));
}

Settings read_settings(const RichParameterList& parameters)
{
    const auto number = [&](const char* name, double least, double most) {
        return std::clamp(static_cast<double>(parameters.getFloat(name)), least, most);
    };
    Settings settings;
    RenderOptions& render = settings.render;
    render.point_size_px = static_cast<float>(number(splat_size, 1, 256));
    render.colour = static_cast<ColourMode>(std::clamp(parameters.getEnum(colour), 0, 3));
    render.target_spacing_px = number(target_spacing, 0.1, 1000);
    render.frame_budget_ms = number(frame_budget, 1, 1e6);
    render.rest_budget_ms = number(rest_budget, 1, 1e6);
    render.point_budget = static_cast<std::uint64_t>(number(point_budget, 0.01, 1e6) * 1e6);
    render.upload_budget_ms = number(upload_budget, 0.1, 1e6);
    settings.l1_bytes = mebibytes(parameters, l1_size, 8);
    settings.l2_bytes = mebibytes(parameters, l2_size, 16);
    return settings;
}

}  // namespace pcm::host
