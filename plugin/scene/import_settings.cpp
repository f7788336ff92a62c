#include "plugin/scene/import_settings.h"

#include "pcm/io/file_text.h"
#include "pcm/io/formats.h"
#include "pcm/io/reader.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <array>

namespace pcm::host {

namespace {

// Names of parameters: of one file, and with the prefix in MeshLab's settings.
const QString global_prefix = "MeshLab::PointCloud::";
const QString largest_layer = "MostPointsInOrdinaryLayer";  // Tools > Options shows this name
const QString draw_layers = "DrawOrdinaryLayersAsPointClouds";
const QString tree_folder = "TreeFolder";
const QString coordinate_limit = "LargestCoordinate";
const QString ask = "ImportDialog";
const QString columns = "Columns";
const QString separator = "Separator";
const QString skip_lines = "SkipLines";
const QString colour_range = "ColourRange";
const QString skip_bad_lines = "SkipBadLines";

enum Ask { never, text_files, always };
constexpr std::array<char, 4> separators{' ', ',', ';', '\t'};  // one for each choice after "Detect"
constexpr std::array<double, 3> colour_ranges{1, 255, 65535};

const auto default_largest = static_cast<int>(ImportSettings().largest_layer);

Parameter largest_layer_parameter(const QString& name, int value)
{
    return {
        name, value, "Most points in an ordinary layer",
        "A point cloud with more points than this becomes a tree on disk, which is drawn at the detail that the view "
        "needs; MeshLab's own tools get a sample of it. One with fewer points is loaded into memory, about 150 bytes "
        "per point, and all of MeshLab's tools work on all of it. In points. Default 1000000."};
}

Parameter tree_folder_parameter(const QString& name, const QString& value)
{
    return {name, value, "Folder for trees",
            "The folder for the trees of large point clouds. Empty, the default: the folder of the file, as "
            "NAME.pct. In another folder a suffix distinguishes files of the same name."};
}

Parameter largest_coordinate_parameter(const QString& name, float value)
{
    return {
        name, value, "Largest coordinate",
        "Points with a coordinate above this or below its negative are left out and counted: no-data values such as "
        "3.4e38, which would leave no precision for the other points. 0, the default: no point is left out."};
}

// The parameter `name` of the file, else the persistent one, else null.
const Parameter* find(const Parameters& parameters, const QString& name)
{
    for (const QString& key : {name, global_prefix + name})
        if (const Parameter* const found = parameters.find(key)) return found;
    return nullptr;
}

}  // namespace

void add_global_settings(Parameters& parameters)
{
    parameters.add(largest_layer_parameter(global_prefix + largest_layer, default_largest));
    parameters.add({global_prefix + draw_layers, true, "Draw ordinary layers as point clouds",
                    "Draw the layer of a small point cloud like a large one, with splats, lighting and "
                    "colours, through a temporary tree of its vertices in the cache folder. Off: "
                    "MeshLab draws it, until Render > Show Point Cloud is switched on. Default on."});
    parameters.add(tree_folder_parameter(global_prefix + tree_folder, ""));
    parameters.add(largest_coordinate_parameter(global_prefix + coordinate_limit, 0));
    parameters.add({global_prefix + ask,
                    int(text_files),
                    "Ask before importing a cloud",
                    "For which files a dialog asks for the layout of text, the largest layer and the folder "
                    "for trees before they are opened. Default: for text files (" +
                        QString::fromStdString(extensions_with(asks_layout)) + ").",
                    {"Never", "For text files", "Always"}});
}

void ask_always(Parameters& globals) { globals.set(global_prefix + ask, int(always)); }

void add_file_settings(Parameters& parameters, const std::filesystem::path& file, const Parameters& globals)
{
    const Format* const format = format_of_extension(extension_of(file));
    const bool is_text = format && format->has(asks_layout);
    const Parameter* asked = find(globals, ask);
    const int when = asked ? asked->value.toInt() : text_files;
    if (when == never || (when == text_files && !is_text)) return;

    if (is_text) {
        QString found, reason;
        std::error_code ignored;
        if (std::filesystem::exists(file, ignored)) try {
                const auto reader = open_reader(file);
                if (const auto& layout = reader->info().text_layout)
                    found = " [found: " + QString::fromStdString(describe(*layout)).toHtmlEscaped() + "]";
            } catch (const Error& error) {
                // Opening the file fails, unless the user specifies the layout.
                found = " [not detected]";
                reason = " They are not detected: " + QString::fromStdString(error.what()).toHtmlEscaped();
            }
        parameters.add({columns, QString(), "Columns" + found,
                        "Names of the columns from the left, separated by blanks: x y z, each once; r g b for "
                        "a colour, nx ny nz for a normal, - for a column to skip, any other name for "
                        "an attribute, such as intensity. Example: x y z intensity r g b. Empty, the "
                        "default: as detected, shown in brackets." +
                            reason});
        parameters.add({separator,
                        0,
                        "Separator",
                        "Separator between columns. Default: as detected.",
                        {"Detect", "Blanks", "Comma", "Semicolon", "Tab"}});
        parameters.add(
            {skip_lines, -1, "Lines to skip", "Number of lines before the first point. -1, the default: as detected."});
        parameters.add({colour_range,
                        0,
                        "Colour range",
                        "Range of the colour components. Default: as detected.",
                        {"Detect", "0 to 1", "0 to 255", "0 to 65535"}});
        parameters.add({skip_bad_lines, false, "Skip bad lines",
                        "Skip lines that are not points instead of refusing the file. Their number and the "
                        "first of them are logged. Default off."});
    }
    const Parameter* points = find(globals, largest_layer);
    const Parameter* folder = find(globals, tree_folder);
    parameters.add(largest_layer_parameter(largest_layer, points ? points->value.toInt() : default_largest));
    parameters.add(tree_folder_parameter(tree_folder, folder ? folder->value.toString() : QString()));
    const Parameter* coordinate = find(globals, coordinate_limit);
    parameters.add(largest_coordinate_parameter(coordinate_limit, coordinate ? coordinate->value.toFloat() : 0));
}

ImportSettings read_import_settings(const Parameters& parameters)
{
    ImportSettings settings;
    if (const Parameter* p = find(parameters, largest_layer))
        settings.largest_layer = static_cast<std::uint64_t>(std::max(0, p->value.toInt()));
    if (const Parameter* p = find(parameters, draw_layers)) settings.draw_layers = p->value.toBool();
    if (const Parameter* p = find(parameters, tree_folder))
        settings.tree_folder = p->value.toString().trimmed().toStdString();
    if (const Parameter* p = find(parameters, coordinate_limit); p && p->value.toFloat() > 0)
        settings.largest_coordinate = p->value.toDouble();
    if (!parameters.has(columns)) return settings;

    const QString text = parameters.text(columns).trimmed();
    if (!text.isEmpty()) settings.text.columns = parse_columns(text.toStdString());
    if (const int i = parameters.whole(separator); i > 0)
        settings.text.separator = separators[static_cast<std::size_t>(i) - 1];
    if (const int n = parameters.whole(skip_lines); n >= 0) settings.text.skip_lines = static_cast<std::size_t>(n);
    if (const int i = parameters.whole(colour_range); i > 0)
        settings.text.colour_range = colour_ranges[static_cast<std::size_t>(i) - 1];
    settings.skip_bad_lines = parameters.has(skip_bad_lines) && parameters.flag(skip_bad_lines);
    return settings;
}

}  // namespace pcm::host
