#include "plugin/settings/settings.h"

#include "plugin/settings/choices.h"

#include <QStringList>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pcm::host {

namespace {

const char* const splat_mode = "MeshLab::PointCloud::Splats";
const char* const splat_size = "MeshLab::PointCloud::SplatSize";
const char* const radius_scale = "MeshLab::PointCloud::RadiusScale";
const char* const samples = "MeshLab::PointCloud::Samples";
const char* const smooth = "MeshLab::PointCloud::Smooth";
const char* const eye_dome = "MeshLab::PointCloud::EyeDomeLighting";
const char* const details = "MeshLab::PointCloud::Details";
const char* const first_view = "MeshLab::PointCloud::FirstView";
const char* const background = "MeshLab::PointCloud::Background";
const char* const with_scale_bar = "MeshLab::PointCloud::ScaleBar";
const char* const with_north = "MeshLab::PointCloud::NorthArrow";
const char* const with_grid = "MeshLab::PointCloud::PlanGrid";
const char* const target_spacing = "MeshLab::PointCloud::TargetSpacing";
const char* const frame_budget = "MeshLab::PointCloud::FrameBudget";
const char* const point_budget = "MeshLab::PointCloud::PointBudget";
const char* const upload_budget = "MeshLab::PointCloud::UploadBudget";
const char* const l1_size = "MeshLab::PointCloud::VideoMemory";
const char* const l2_size = "MeshLab::PointCloud::Memory";

const QColor backgrounds[] = {Qt::black, QColor(64, 64, 64), Qt::white};  // backgrounds of the choices after MeshLab's
const QStringList sample_counts{"1 (off)", "2", "4", "8"};

// "a; b; or c" of their descriptions.
template <class Table>
QString descriptions_of(const Table& modes, const QString& separator)
{
    QStringList list;
    for (const auto& row : modes) list << row.description;
    list.last().prepend("or ");
    return list.join(separator);
}

std::uint64_t mebibytes(const Parameters& parameters, const char* name, int least)
{
    return static_cast<std::uint64_t>(std::clamp(parameters.whole(name), least, 1 << 24)) << 20;
}

// Splats, their size and their colours.
void add_style(Parameters& parameters)
{
    const CloudStyle style;
    parameters.add({splat_mode, static_cast<int>(style.splats), "Splats",
                    "What a point is drawn as: " + descriptions_of(splat_modes(), "; ") +
                        ". A cloud without normals is shown with the most similar of these that "
                        "needs none, and the log reports it. Default: Fitted.",
                    labels_of(splat_modes())});
    parameters.add({splat_size, style.point_size_px, "Splat size (px)",
                    "Side of the squares of one size, in pixels, from 1 to 256. Default 2."});
    parameters.add({radius_scale, style.radius_scale, "Radius scale",
                    "Factor on the points' radii or sizes, from 0.001 to 1000, for the other splats. Default 1."});
    add_colour_settings(parameters);
}

void add_lighting(Parameters& parameters)
{
    const RenderOptions render;
    parameters.add(
        {eye_dome, render.eye_dome, "Eye-dome lighting",
         QString("Darkens points that lie behind their neighbours on the screen, with a strength from 0 (off) to 10. "
                 "It shows shapes in clouds without normals or colours. Default %1.")
             .arg(static_cast<double>(render.eye_dome))});
}

// Quality of the picture: multisampling, level of detail.
void add_quality(Parameters& parameters)
{
    const RenderOptions render;
    int default_samples = 0;
    for (int i = 0; i < sample_counts.size(); ++i)
        if ((1u << i) <= render.samples) default_samples = i;
    parameters.add(
        {samples, default_samples, "Samples per pixel",
         "Multisampling of edges (MSAA), in samples per pixel, limited to what the graphics card supports. Default " +
             sample_counts[default_samples] + ".",
         sample_counts});
    parameters.add(
        {smooth, true, "Smooth at rest",
         QString("Whether a view that rests, when all its points are shown, becomes the mean of %1 frames at sub-pixel "
                 "offsets: edges and far textures lose their stairs and speckles, and turn calmly. Views of more than "
                 "25 million points have fewer. Default on.")
             .arg(usual_smooth_frames)});
    parameters.add({target_spacing, static_cast<float>(render.target_spacing_px), "Target spacing (px)",
                    QString("Largest distance between neighbouring points on the screen while the view "
                            "moves, in pixels, from 0.1 to 1000. Default %1.")
                        .arg(render.target_spacing_px)});
}

void add_background(Parameters& parameters)
{
    parameters.add({background,
                    0,
                    "Background",
                    "What is behind the clouds: the gradient of MeshLab's Tools > Options, or one colour. "
                    "Default MeshLab's.",
                    {"MeshLab's", "Black", "Grey", "White"}});
}

void add_map_marks(Parameters& parameters)
{
    const MapSettings map;
    parameters.add({with_scale_bar, map.scale_bar, "Scale bar",
                    "A bar of a round length in source units, in the lower left corner. Exact in "
                    "orthographic views; in perspective it holds for lengths across the view at the "
                    "distance of the trackball's centre. Default on."});
    parameters.add({with_north, map.north, "North arrow",
                    "An arrow in the direction of +y of source coordinates, shorter where it is seen "
                    "obliquely. Default off."});
    parameters.add({with_grid, map.grid, "Coordinate grid in plan view",
                    "Lines of round x and y, with their source coordinates at the border, in orthographic "
                    "views that look down (within 2 degrees). Default off."});
}

void add_details(Parameters& parameters)
{
    parameters.add({details, false, "Show details",
                    "Whether the text in the view also has the time per frame, in milliseconds, the "
                    "screen error, in pixels, and how full the caches are. Default off."});
}

void add_first_view(Parameters& parameters)
{
    parameters.add({first_view,
                    0,
                    "First view",
                    "Where a view looks from when a cloud is opened in it and it shows nothing else: "
                    "obliquely from above, or, of a single scan whose file states it, from where it was "
                    "taken; or straight down as MeshLab does. Default obliquely.",
                    {"Obliquely from above", "From above"}});
}

// Limits of time and memory.
void add_budgets(Parameters& parameters)
{
    const RenderOptions render;
    parameters.add(
        {frame_budget, static_cast<float>(render.frame_budget_ms), "Frame budget (ms)",
         QString(
             "Time for drawing a frame, in milliseconds, at least 1. While the view moves, fewer points are drawn if "
             "all of them would take longer. While it rests, the others are added frame by frame up to full "
             "resolution. Default %1.")
             .arg(render.frame_budget_ms)});
    parameters.add(
        {point_budget, static_cast<float>(static_cast<double>(render.point_budget) / 1e6), "Point budget (millions)",
         QString(
             "Largest number of points drawn in a frame, for all layers together, in millions, at least 0.01. Default "
             "%1.")
             .arg(static_cast<double>(render.point_budget) / 1e6)});
    parameters.add({upload_budget, static_cast<float>(render.upload_budget_ms), "Upload budget (ms)",
                    QString("Time per frame for uploading new points to the graphics card while the view "
                            "moves, in milliseconds, at least 0.1. Default %1.")
                        .arg(render.upload_budget_ms)});
    parameters.add(
        {l1_size, static_cast<int>(L1Options().capacity_bytes >> 20), "Video memory (MB)",
         QString(
             "Memory on the graphics card for the points of all layers of a project, in megabytes, at least 8. Default "
             "%1.")
             .arg(L1Options().capacity_bytes >> 20)});
    parameters.add(
        {l2_size, static_cast<int>(L2Options().capacity_bytes >> 20), "Memory (MB)",
         QString("Main memory for the points of each cloud, in megabytes, at least 16. Points that do not fit are "
                 "read from disk again. Default %1.")
             .arg(L2Options().capacity_bytes >> 20)});
}

}  // namespace

void add_first_settings(Parameters& parameters)
{
    add_style(parameters);
    add_lighting(parameters);
    add_background(parameters);
}

void add_settings(Parameters& parameters)
{
    add_first_settings(parameters);
    add_details(parameters);
    add_map_marks(parameters);
    add_quality(parameters);
    add_first_view(parameters);
    add_budgets(parameters);
}

bool is_memory(const QString& name) { return name == l1_size || name == l2_size; }

bool zero_is_off(const QString& name) { return name == eye_dome; }

Settings read_settings(const Parameters& parameters)
{
    const auto number = [&](const char* name, double least, double most) {
        return std::clamp(static_cast<double>(parameters.real(name)), least, most);
    };
    Settings settings;
    CloudStyle& style = settings.style;
    style.splats = static_cast<SplatMode>(choice_of(parameters, splat_mode, splat_modes()));
    settings.colour = read_colour_settings(parameters, style);
    style.point_size_px = static_cast<float>(number(splat_size, 1, 256));
    style.radius_scale = static_cast<float>(number(radius_scale, 1e-3, 1e3));
    RenderOptions& render = settings.render;
    render.samples = 1u << choice_of(parameters, samples, sample_counts);
    render.smooth_frames = parameters.flag(smooth) ? usual_smooth_frames : 1;
    render.eye_dome = static_cast<float>(number(eye_dome, 0, 10));
    render.target_spacing_px = number(target_spacing, 0.1, 1000);
    render.frame_budget_ms = number(frame_budget, 1, 1e6);
    render.point_budget = static_cast<std::uint64_t>(number(point_budget, 0.01, 1e6) * 1e6);
    render.upload_budget_ms = number(upload_budget, 0.1, 1e6);
    settings.oblique_first_view = parameters.whole(first_view) == 0;
    if (const int i = parameters.whole(background); i > 0 && i <= int(std::size(backgrounds)))
        settings.background = backgrounds[i - 1];
    settings.map.scale_bar = parameters.flag(with_scale_bar);
    settings.map.north = parameters.flag(with_north);
    settings.map.grid = parameters.flag(with_grid);
    settings.details = parameters.flag(details);
    settings.l1_bytes = mebibytes(parameters, l1_size, 8);
    settings.l2_bytes = mebibytes(parameters, l2_size, 16);
    return settings;
}

}  // namespace pcm::host
