#include "plugin/meshlab/io/export.h"

#include "pcm/convert/convert.h"
#include "pcm/io/formats.h"
#include "pcm/io/pipe/require_points.h"
#include "pcm/io/pipe/selected_reader.h"
#include "pcm/io/pipe/transformed_reader.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_reader.h"
#include "plugin/meshlab/document_scene.h"
#include "plugin/meshlab/layer_reader.h"
#include "plugin/meshlab/meshlab.h"
#include "plugin/meshlab/placement.h"
#include "plugin/meshlab/registry.h"
#include "plugin/meshlab/sample_change.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/selection_text.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

// Names of parameters. MeshLab sets the first one for meshlabserver's option -m sa.
const QString binary = "Binary";
const QString selected_only = "SelectedOnly";
const QString level = "Level";
const QString apply_matrix = "ApplyMatrix";
const QString box = "Box";
const QString where = "Where";
const QString clip_box_only = "ClipBoxOnly";
const QString decimals = "Decimals";
const QString las_version = "LasVersion";
const QString colour_bits = "ColourBits";
const QString float_positions = "FloatPositions";

// What the document's clip box shows of the layer's points, which are written where they are without its matrix.
Clip clip_for(const MeshModel& layer)
{
    const auto& clip = scene_of(document_of(layer)).part<SceneState>().clip();
    if (!clip || !clip->enabled)
        throw Error(ErrorCode::invalid_argument, {}, "there is no clip box, or it is switched off",
                    "untick 'Only what the clip box shows', or switch the clip box on");
    if (auto placed = clip_of(layer_of(layer))) return *placed;
    if (layer.cm.Tr != Matrix44m::Identity())
        throw Error(ErrorCode::unsupported, {},
                    "the clip box does not apply to a layer with a matrix that is not drawn as a point cloud",
                    "switch Render > Show Point Cloud on for the layer");
    return clip->clip(std::nullopt);
}

Selection selection_of(const MeshModel& layer, const Parameters& parameters)
{
    Selection selection = parse_selection(parameters.text(box), parameters.text(where));
    if (parameters.has(clip_box_only) && parameters.flag(clip_box_only)) selection.clips.push_back(clip_for(layer));
    return selection;
}

std::unique_ptr<PointReader> reader_of_tree(const TreeLayer& layer, const Selection& selection,
                                            const Parameters& parameters)
{
    const int chosen = parameters.whole(level);
    const int deepest = static_cast<int>(layer.cloud->info().levels) - 1;
    if (chosen > deepest)
        throw Error(
            ErrorCode::invalid_argument, {},
            "the tree has no level " + std::to_string(chosen) + "; the deepest level is " + std::to_string(deepest));
    const auto asked = chosen < 0 ? std::nullopt : std::optional(static_cast<std::uint16_t>(chosen));
    return std::make_unique<TreeReader>(layer.cloud->tree(), asked, selection);
}

LayerSelection members_of(int mask, bool selected)
{
    namespace io = vcg::tri::io;
    LayerSelection selection;
    selection.selected_only = selected;
    selection.colour = mask & io::Mask::IOM_VERTCOLOR;
    selection.normal = mask & io::Mask::IOM_VERTNORMAL;
    selection.quality = mask & io::Mask::IOM_VERTQUALITY;
    selection.radius = mask & io::Mask::IOM_VERTRADIUS;
    return selection;
}

// What only some formats have.
void add_format_settings(Parameters& parameters, const Format& format)
{
    if (format.has(takes_las_version))
        parameters.add({las_version,
                        0,
                        "LAS version",
                        "By default that of the LAS file that the points came from, or the lowest one that "
                        "holds everything. Programs that read 1.2 alone need 1.2.",
                        {"As the source, or the lowest", "1.0", "1.1", "1.2", "1.3", "1.4"}});
    if (format.has(takes_colour_bits))
        parameters.add({colour_bits,
                        0,
                        "Colour bits",
                        "Other programs show colours of 8 bits. By default those of 16 bits are written with "
                        "8, and exactly in addition unless 8 bits hold them all.",
                        {"8, and the exact ones where 8 do not hold them", "8", "16"}});
    if (format.has(takes_float_positions))
        parameters.add({float_positions, false, "Float positions",
                        "Positions as floats relative to a whole-numbered shift, which is in VIEWPOINT: PCL "
                        "and Open3D take doubles for zeros. Default off."});
}

void take_format_settings(const Parameters& parameters, WriteOptions& options)
{
    if (parameters.has(las_version) && parameters.whole(las_version) > 0)
        options.las_version = static_cast<unsigned>(parameters.whole(las_version) - 1);
    if (parameters.has(colour_bits) && parameters.whole(colour_bits) > 0)
        options.colour_bits = parameters.whole(colour_bits) == 1 ? 8u : 16u;
    if (parameters.has(float_positions)) options.float_positions = parameters.flag(float_positions);
}

// Where the layer's matrix puts the points that are written; nothing where they stay, or it is not to be applied.
std::optional<Affine> placement_to_write(const MeshModel& layer, const Parameters& parameters)
{
    if (parameters.has(apply_matrix) && !parameters.flag(apply_matrix)) return std::nullopt;
    if (const auto tree = Registry::instance().find(layer)) return placement_of(layer, *tree);
    return matrix_map_of(layer);
}

std::unique_ptr<PointReader> moved(std::unique_ptr<PointReader> points, const std::optional<Affine>& map)
{
    if (!map) return points;
    return std::make_unique<TransformedReader>(std::move(points), *map);
}

std::vector<std::string> layer_lines(const MeshModel& layer, const LayerReader& reader, const LayerSelection& taken)
{
    std::vector<std::string> lines;
    const bool from_file = Registry::instance().source_of(layer) != nullptr;
    if (from_file && reader.moved() == 0)
        lines.emplace_back("Coordinates are those of the file that the layer came from.");
    else if (from_file)
        lines.push_back(
            grouped(reader.moved()) +
            " vertices were moved; their coordinates are MeshLab's, rounded to float relative to the document's "
            "origin.");
    std::string left_out;
    const auto check = [&](bool wanted, int flag, const char* name) {
        if (!wanted && layer.hasDataMask(flag)) left_out += (left_out.empty() ? "" : ", ") + std::string(name);
    };
    check(taken.colour, MeshModel::MM_VERTCOLOR, "colours");
    check(taken.quality, MeshModel::MM_VERTQUALITY, "quality");
    check(taken.radius, MeshModel::MM_VERTRADIUS, "radius");
    const auto source = Registry::instance().source_of(layer);
    if (!taken.normal && source && source->has(AttributePlace::Kind::normal))
        left_out += (left_out.empty() ? "" : ", ") + std::string("normals");
    if (!left_out.empty()) lines.push_back("Not written, because not ticked: " + left_out + ".");
    return lines;
}

}  // namespace

bool is_ours_to_write(const MeshModel& layer)
{
    const Registry& registry = Registry::instance();
    if (registry.find(layer)) return true;
    if (layer.cm.fn > 0 || layer.cm.en > 0) return false;
    const auto origin = registry.origin_of(document_of(layer));
    return registry.source_of(layer) || (origin && *origin != Vec3d{0, 0, 0});
}

void add_export_settings(Parameters& parameters, const std::string& extension, const MeshModel& layer)
{
    const Format* const format = format_of_extension(extension);
    if (format && format->has(takes_ascii))
        parameters.add(
            {binary, true, "Binary encoding", "Binary, which is smaller and faster, or plain text. Default on."});
    if (format && format->has(takes_decimals))
        parameters.add(
            {decimals, -1, "Decimals",
             "Digits after the decimal point of a coordinate, from 0 to 30. -1, the default: as many as are needed to "
             "read back the same number."});
    if (const auto tree = Registry::instance().find(layer))
        parameters.add({level, -1, "Level",
                        "Write the cloud at this level of detail, from 0 to " +
                            QString::number(tree->cloud->info().levels - 1) + ". -1, the default: all points."});
    else
        parameters.add({selected_only, false, "Selected vertices only",
                        "Write only the vertices that are selected. Default off."});
    parameters.add({apply_matrix, true, "Apply the layer's matrix",
                    "Write the points where the layer's matrix moves them, as the view shows them; a box "
                    "and conditions choose points before that. Off: where the cloud has them. Default "
                    "on."});
    parameters.add({box, QString(), "Box",
                    "Write only points inside this box: its smallest x y z and its largest x y z, six "
                    "numbers separated by blanks, in source coordinates and units, bounds included. "
                    "Empty, the default: no box."});
    parameters.add({where, QString(), "Where",
                    "Write only points that meet these conditions on attributes, separated by semicolons. "
                    "Example: classification = 2,6; intensity >= 100. Empty, the default: no condition."});
    parameters.add({clip_box_only, false, "Only what the clip box shows",
                    "Write only points that the project's clip box shows. Default off."});
    if (format) add_format_settings(parameters, *format);
}

int export_mask()
{
    namespace io = vcg::tri::io;
    return io::Mask::IOM_VERTCOLOR | io::Mask::IOM_VERTNORMAL | io::Mask::IOM_VERTQUALITY | io::Mask::IOM_VERTRADIUS;
}

std::vector<std::string> export_layer(const std::filesystem::path& path, const MeshModel& layer, int mask,
                                      const Parameters& parameters, const ProgressFunction& progress)
{
    ConvertOptions options;
    if (parameters.has(binary)) options.write.ascii = !parameters.flag(binary);
    if (parameters.has(decimals) && parameters.whole(decimals) >= 0)
        options.write.decimals = static_cast<unsigned>(parameters.whole(decimals));
    take_format_settings(parameters, options.write);
    options.progress = progress;

    std::vector<std::string> lines;
    ConvertReport report;
    std::string what;
    const Selection selection = selection_of(layer, parameters);
    const std::optional<Affine> placement = placement_to_write(layer, parameters);
    if (const auto tree = Registry::instance().find(layer)) {
        const auto bounds = [&] { return tree->cloud->info().bounds(); };
        const auto open = [&] {
            return require_points(moved(reader_of_tree(*tree, selection, parameters), placement), bounds);
        };
        report = write_cloud(open, path, options);
        what = "of the tree " + tree->cloud->tree()->folder().string();
    } else {
        const LayerSelection taken = members_of(mask, parameters.flag(selected_only));
        const auto open = [&] {
            auto vertices = std::make_unique<LayerReader>(layer, taken);
            lines = layer_lines(layer, *vertices, taken);
            const auto passed = std::make_shared<Box3d>();
            return require_points(
                moved(std::make_unique<SelectedReader>(std::move(vertices), selection, passed), placement),
                [passed] { return *passed; });
        };
        report = write_cloud(open, path, options);
        what = "of the layer " + layer.label().toStdString();
    }
    lines.insert(lines.begin(), "Wrote " + grouped(report.outcome.points_out) + " points " + what + " to " +
                                    path.string() + " in " + brief(report.outcome.seconds) +
                                    " s, in source coordinates; largest position error " + exact(report.outcome.error) +
                                    " source units.");
    for (const std::string& note : report.notes) lines.push_back("Note: " + note);
    for (const std::string& warning : report.outcome.warnings) lines.push_back("Warning: " + warning);
    if (const std::string changed = sample_warning(layer); !changed.empty()) lines.push_back("Warning: " + changed);
    if (placement)
        lines.emplace_back("The points are where the layer's matrix moves them.");
    else if (layer.cm.Tr != Matrix44m::Identity())
        lines.emplace_back("The layer's matrix was not applied.");
    return lines;
}

}  // namespace pcm::host
