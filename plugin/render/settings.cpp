#include "plugin/render/settings.h"

#include <QColor>
#include <QStringList>

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

const char* const splat_mode = "MeshLab::PointCloud::Splats";
const char* const splat_size = "MeshLab::PointCloud::SplatSize";
const char* const radius_scale = "MeshLab::PointCloud::RadiusScale";
const char* const colour = "MeshLab::PointCloud::Colour";
const char* const uniform_colour = "MeshLab::PointCloud::UniformColour";
const char* const samples = "MeshLab::PointCloud::Samples";
const char* const eye_dome = "MeshLab::PointCloud::EyeDomeLighting";
const char* const target_spacing = "MeshLab::PointCloud::TargetSpacing";
const char* const frame_budget = "MeshLab::PointCloud::FrameBudget";
const char* const point_budget = "MeshLab::PointCloud::PointBudget";
const char* const upload_budget = "MeshLab::PointCloud::UploadBudget";
const char* const l1_size = "MeshLab::PointCloud::VideoMemory";
const char* const l2_size = "MeshLab::PointCloud::Memory";

const QStringList sample_counts{"1 (off)", "2", "4", "8"};

// The choices of a table of modes: splat_modes() or colour_modes().
template <class Table>
QStringList labels_of(const Table& modes)
{
    QStringList labels;
    for (const auto& row : modes) labels << row.label;
    return labels;
}

// "a; b; or c" of their descriptions.
template <class Table>
QString descriptions_of(const Table& modes, const QString& separator)
{
    QStringList list;
    for (const auto& row : modes) list << row.description;
    list.last().prepend("or ");
    return list.join(separator);
}

std::uint64_t mebibytes(const RichParameterList& parameters, const char* name, int least)
{
    return static_cast<std::uint64_t>(std::clamp(parameters.getInt(name), least, 1 << 24)) << 20;
}

// Splats, their size and their colours.
void add_style(RichParameterList& parameters)
{
    const CloudStyle style;
    parameters.addParam(RichEnum(splat_mode, static_cast<int>(style.splats), labels_of(splat_modes()), "Splats",
                                 "What a point is drawn as: " + descriptions_of(splat_modes(), "; ") +
                                     ". A cloud without normals is shown with the most similar of these that "
                                     "needs none, and the log says so. Default: adaptive."));
    parameters.addParam(RichFloat(splat_size, style.point_size_px, "Splat size (px)",
                                  "Side of the squares of one size, in pixels, from 1 to 256. Default 2."));
    parameters.addParam(
        RichFloat(radius_scale, style.radius_scale, "Radius scale",
                  "Factor on the points' radii or sizes, from 0.001 to 1000, for the other splats. Default 1."));
    parameters.addParam(
        RichEnum(colour, static_cast<int>(style.colour), labels_of(colour_modes()), "Colour by",
                 "What the colour of a point shows: " + descriptions_of(colour_modes(), ", ") +
                     ". A cloud without colours shows its intensity, and one without that its height. Default RGB."));
    const auto byte = [&](std::size_t i) { return qRound(255 * style.uniform_colour[i]); };
    parameters.addParam(RichColor(uniform_colour, QColor(byte(0), byte(1), byte(2)), "Uniform colour",
                                  "Colour of all points if Colour by is Uniform. Default light grey."));
}

// Quality of the picture: multisampling, lighting, level of detail.
void add_quality(RichParameterList& parameters)
{
    const RenderOptions render;
    int default_samples = 0;
    for (int i = 0; i < sample_counts.size(); ++i)
        if ((1u << i) <= render.samples) default_samples = i;
    parameters.addParam(RichEnum(
        samples, default_samples, sample_counts, "Samples per pixel",
        "Multisampling of edges (MSAA), in samples per pixel, limited to what the graphics card supports. Default " +
            sample_counts[default_samples] + "."));
    parameters.addParam(RichFloat(
        eye_dome, render.eye_dome, "Eye-dome lighting",
        QString("Darkens points that lie behind their neighbours on the screen, with a strength from 0 (off) to 10. "
                "It shows shapes in clouds without normals or colours. Default %1.")
            .arg(static_cast<double>(render.eye_dome))));
    parameters.addParam(RichFloat(target_spacing, static_cast<float>(render.target_spacing_px), "Target spacing (px)",
                                  QString("Largest distance between neighbouring points on the screen while the view "
                                          "moves, in pixels, from 0.1 to 1000. Default %1.")
                                      .arg(render.target_spacing_px)));
}

// Limits of time and memory.
void add_budgets(RichParameterList& parameters)
{
    const RenderOptions render;
    parameters.addParam(RichFloat(
        frame_budget, static_cast<float>(render.frame_budget_ms), "Frame budget (ms)",
        QString(
            "Time for drawing a frame, in milliseconds, at least 1. While the view moves, fewer points are drawn if "
            "all of them would take longer. While it rests, the others are added frame by frame up to full "
            "resolution. Default %1.")
            .arg(render.frame_budget_ms)));
    parameters.addParam(RichFloat(
        point_budget, static_cast<float>(static_cast<double>(render.point_budget) / 1e6), "Point budget (millions)",
        QString(
            "Largest number of points drawn in a frame, for all layers together, in millions, at least 0.01. Default "
            "%1.")
            .arg(static_cast<double>(render.point_budget) / 1e6)));
    parameters.addParam(RichFloat(upload_budget, static_cast<float>(render.upload_budget_ms), "Upload budget (ms)",
                                  QString("Time per frame for uploading new points to the graphics card while the view "
                                          "moves, in milliseconds, at least 0.1. Default %1.")
                                      .arg(render.upload_budget_ms)));
    parameters.addParam(RichInt(
        l1_size, static_cast<int>(L1Options().capacity_bytes >> 20), "Video memory (MB)",
        QString(
            "Memory on the graphics card for the points of all layers of a project, in megabytes, at least 8. Default "
            "%1.")
            .arg(L1Options().capacity_bytes >> 20)));
    parameters.addParam(RichInt(
        l2_size, static_cast<int>(L2Options().capacity_bytes >> 20), "Memory (MB)",
        QString("Main memory for the points of each cloud, in megabytes, at least 16. Points that do not fit are "
                "read from disk again. Default %1.")
            .arg(L2Options().capacity_bytes >> 20)));
}

}  // namespace

void add_settings(RichParameterList& parameters)
{
    add_style(parameters);
    add_quality(parameters);
    add_budgets(parameters);
}

Settings read_settings(const RichParameterList& parameters)
{
    const auto number = [&](const char* name, double least, double most) {
        return std::clamp(static_cast<double>(parameters.getFloat(name)), least, most);
    };
    Settings settings;
    const auto choice = [&](const char* name, const auto& of) {
        return std::clamp(parameters.getEnum(name), 0, int(of.size()) - 1);
    };
    CloudStyle& style = settings.style;
    style.splats = static_cast<SplatMode>(choice(splat_mode, splat_modes()));
    style.colour = static_cast<ColourMode>(choice(colour, colour_modes()));
    style.point_size_px = static_cast<float>(number(splat_size, 1, 256));
    style.radius_scale = static_cast<float>(number(radius_scale, 1e-3, 1e3));
    const QColor uniform = parameters.getColor(uniform_colour);
    style.uniform_colour = {static_cast<float>(uniform.redF()), static_cast<float>(uniform.greenF()),
                            static_cast<float>(uniform.blueF())};
    RenderOptions& render = settings.render;
    render.samples = 1u << choice(samples, sample_counts);
    render.eye_dome = static_cast<float>(number(eye_dome, 0, 10));
    render.target_spacing_px = number(target_spacing, 0.1, 1000);
    render.frame_budget_ms = number(frame_budget, 1, 1e6);
    render.point_budget = static_cast<std::uint64_t>(number(point_budget, 0.01, 1e6) * 1e6);
    render.upload_budget_ms = number(upload_budget, 0.1, 1e6);
    settings.l1_bytes = mebibytes(parameters, l1_size, 8);
    settings.l2_bytes = mebibytes(parameters, l2_size, 16);
    return settings;
}

}  // namespace pcm::host
