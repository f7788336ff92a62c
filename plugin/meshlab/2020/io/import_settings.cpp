#include "plugin/meshlab/2020/io/import_settings.h"

#include "plugin/meshlab/2020/meshlab.h"

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
const QString largest_coordinate = "LargestCoordinate";
const QString ask = "ImportDialog";
const QString columns = "Columns";
const QString separator = "Separator";
const QString skip_lines = "SkipLines";
const QString colour_range = "ColourRange";
const QString skip_bad_lines = "SkipBadLines";

enum Ask { never, text_files, always };
constexpr std::array<char, 4> separators{' ', ',', ';', '\t'};  // of the choices after "Detect"
constexpr std::array<double, 3> colour_ranges{1, 255, 65535};

const auto default_largest = static_cast<int>(ImportSettings().largest_layer);

RichInt largest_layer_parameter(const QString& name, int value)
{
    return RichInt(
        name, value, "Most points in an ordinary layer",
        "A point cloud with more points than this becomes a tree on disk, which is drawn at the detail that the view "
        "needs; MeshLab's own tools get a sample of it. One with fewer points is loaded into memory, about 150 bytes "
        "per point, and all of MeshLab's tools work on all of it. In points. Default 1000000.");
}

RichString tree_folder_parameter(const QString& name, const QString& value)
{
    return RichString(name, value, "Folder for trees",
                      "The folder for the trees of large point clouds. Empty, the default: the folder of the file, as "
                      "NAME.pct. In another folder a suffix distinguishes files of the same name.");
}

RichFloat largest_coordinate_parameter(const QString& name, float value)
{
    return RichFloat(
        name, value, "Largest coordinate",
        "Points with a coordinate above this or below its negative are left out and counted: no-data values such as "
        "3.4e38, which would leave no precision for the other points. 0, the default: no point is left out.");
}

// MeshLab's current settings; null without a window.
const RichParameterList* current_globals()
{
    for (QWidget* widget : QApplication::allWidgets())
        if (widget->inherits("GLArea")) return static_cast<GLArea*>(widget)->glas.currentGlobalParamSet;
    return nullptr;
}

// The parameter `name` of the file, else the persistent one, else null.
const RichParameter* find(const RichParameterList& parameters, const QString& name)
{
    for (const QString& key : {name, global_prefix + name})
        if (parameters.hasParameter(key)) return &parameters.getParameterByName(key);
    return nullptr;
}

}  // namespace

void add_global_settings(RichParameterList& parameters)
{
    parameters.addParam(largest_layer_parameter(global_prefix + largest_layer, default_largest));
    parameters.addParam(RichBool(global_prefix + draw_layers, true, "Draw ordinary layers as point clouds",
                                 "Draw the layer of a small point cloud like a large one, with splats, lighting and "
                                 "colours, through a temporary tree of its vertices in the cache folder. Off: "
                                 "MeshLab draws it, until Render > Show Point Cloud is switched on. Default on."));
    parameters.addParam(tree_folder_parameter(global_prefix + tree_folder, ""));
    parameters.addParam(largest_coordinate_parameter(global_prefix + largest_coordinate, 0));
    parameters.addParam(
        RichEnum(global_prefix + ask, text_files, {"Never", "For text files", "Always"}, "Ask before importing a cloud",
                 "For which files a dialog asks for the layout of text, the largest layer and the folder "
                 "for trees before they are opened. Default: for text files (" +
                     QString::fromStdString(extensions_with(asks_layout)) + ")."));
}

void add_file_settings(RichParameterList& parameters, const std::filesystem::path& file)
{
    const RichParameterList* globals = current_globals();
    if (!globals) return;
    const Format* const format = format_of_extension(extension_of(file));
    const bool is_text = format && format->has(asks_layout);
    const RichParameter* asked = find(*globals, ask);
    const int when = asked ? asked->value().getEnum() : text_files;
    if (when == never || (when == text_files && !is_text)) return;

    if (is_text) {
        QString found, reason;
        try {
            const auto reader = open_reader(file);
            if (const auto& layout = reader->info().text_layout)
                found = " [found: " + QString::fromStdString(describe(*layout)).toHtmlEscaped() + "]";
        } catch (const Error& error) {
            // Opening the file fails, unless the user specifies the layout.
            found = " [not detected]";
            reason = " They are not detected: " + QString::fromStdString(error.what()).toHtmlEscaped();
        }
        parameters.addParam(
            RichString(columns, "", "Columns" + found,
                       "Names of the columns from the left, separated by blanks: x y z, each once; r g b for "
                       "a colour, nx ny nz for a normal, - for a column to skip, any other name for "
                       "an attribute, such as intensity. Example: x y z intensity r g b. Empty, the "
                       "default: as detected, shown in brackets." +
                           reason));
        parameters.addParam(RichEnum(separator, 0, {"Detect", "Blanks", "Comma", "Semicolon", "Tab"}, "Separator",
                                     "Separator between columns. Default: as detected."));
        parameters.addParam(RichInt(skip_lines, -1, "Lines to skip",
                                    "Number of lines before the first point. -1, the default: as detected."));
        parameters.addParam(RichEnum(colour_range, 0, {"Detect", "0 to 1", "0 to 255", "0 to 65535"}, "Colour range",
                                     "Range of the colour components. Default: as detected."));
        parameters.addParam(
            RichBool(skip_bad_lines, false, "Skip bad lines",
                     "Skip lines that are not points instead of refusing the file. Their number and the "
                     "first of them are logged. Default off."));
    }
    const RichParameter* points = find(*globals, largest_layer);
    const RichParameter* folder = find(*globals, tree_folder);
    parameters.addParam(largest_layer_parameter(largest_layer, points ? points->value().getInt() : default_largest));
    parameters.addParam(tree_folder_parameter(tree_folder, folder ? folder->value().getString() : QString()));
    const RichParameter* coordinate = find(*globals, largest_coordinate);
    parameters.addParam(
        largest_coordinate_parameter(largest_coordinate, coordinate ? coordinate->value().getFloat() : 0));
}

ImportSettings read_import_settings(const RichParameterList& parameters)
{
    ImportSettings settings;
    if (const RichParameter* p = find(parameters, largest_layer))
        settings.largest_layer = static_cast<std::uint64_t>(std::max(0, p->value().getInt()));
    if (const RichParameter* p = find(parameters, draw_layers)) settings.draw_layers = p->value().getBool();
    if (const RichParameter* p = find(parameters, tree_folder))
        settings.tree_folder = p->value().getString().trimmed().toStdString();
    if (const RichParameter* p = find(parameters, largest_coordinate); p && p->value().getFloat() > 0)
        settings.largest_coordinate = static_cast<double>(p->value().getFloat());
    if (!parameters.hasParameter(columns)) return settings;

    const QString text = parameters.getString(columns).trimmed();
    if (!text.isEmpty()) settings.text.columns = parse_columns(text.toStdString());
    if (const int i = parameters.getEnum(separator); i > 0)
        settings.text.separator = separators[static_cast<std::size_t>(i) - 1];
    if (const int n = parameters.getInt(skip_lines); n >= 0) settings.text.skip_lines = static_cast<std::size_t>(n);
    if (const int i = parameters.getEnum(colour_range); i > 0)
        settings.text.colour_range = colour_ranges[static_cast<std::size_t>(i) - 1];
    settings.skip_bad_lines = parameters.hasParameter(skip_bad_lines) && parameters.getBool(skip_bad_lines);
    return settings;
}

}  // namespace pcm::host
