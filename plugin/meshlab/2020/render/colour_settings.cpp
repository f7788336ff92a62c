#include "plugin/meshlab/2020/render/colour_settings.h"

#include "pcm/cloud/condition.h"
#include "plugin/meshlab/2020/render/choices.h"
#include "plugin/scene/text.h"

#include <QStringList>

#include <algorithm>

namespace pcm::host {

namespace {

const char* const colour = "MeshLab::PointCloud::Colour";
const char* const attribute = "MeshLab::PointCloud::Attribute";
const char* const ramp = "MeshLab::PointCloud::Ramp";
const char* const range = "MeshLab::PointCloud::Range";
const char* const legend = "MeshLab::PointCloud::Legend";
const char* const conditions = "MeshLab::PointCloud::Conditions";
const char* const hidden_classes = "MeshLab::PointCloud::HiddenClasses";
const char* const uniform_colour = "MeshLab::PointCloud::UniformColour";
const char* const brightness = "MeshLab::PointCloud::Brightness";
const char* const gamma_value = "MeshLab::PointCloud::Gamma";

template <class Table>
QString descriptions_of(const Table& rows)
{
    QStringList list;
    for (const auto& row : rows) list << QString(row.label) + ": " + row.description;
    return list.join("; ");
}

// Calls `read`, and adds what it throws to `problem`.
template <class Read>
void attempt(QString& problem, const char* label, const Read& read)
{
    try {
        read();
    } catch (...) {
        if (!problem.isEmpty()) problem += "; ";
        problem += QString(label) + ": " + QString::fromStdString(current_error());
    }
}

std::set<unsigned> classes_of(const QString& text, QString& problem)
{
    std::set<unsigned> classes;
    for (const QString& word : text.split(QRegExp("[,;\\s]+"), Qt::SkipEmptyParts)) {
        bool is_number = false;
        const unsigned number = word.toUInt(&is_number);
        if (is_number && number < 256) {
            classes.insert(number);
        } else {
            if (!problem.isEmpty()) problem += "; ";
            problem += "Hidden classes: '" + word + "' is not a class (write numbers from 0 to 255, as in 7, 18)";
        }
    }
    return classes;
}

QString text_of(const std::set<unsigned>& classes)
{
    QStringList numbers;
    for (const unsigned number : classes) numbers << QString::number(number);
    return numbers.join(", ");
}

}  // namespace

void add_colour_settings(RichParameterList& parameters)
{
    const CloudStyle style;
    parameters.addParam(RichEnum(colour, static_cast<int>(style.colour), labels_of(colour_modes()), "Colour by",
                                 "What the colour of a point shows: " + descriptions_of(colour_modes()) +
                                     ". A cloud whose colours are absent or all the same shows its classes, and one "
                                     "without these its height, with the intensity as brightness where that shows "
                                     "shape. Default RGB."));
    parameters.addParam(RichString(attribute, "", "Attribute",
                                   "With Colour by Attribute: the name of the attribute, such as gps_time or "
                                   "return_number, or of one of its components, such as normal[2]. Tree Information "
                                   "lists the names. Default: none."));
    parameters.addParam(RichEnum(ramp, static_cast<int>(style.ramp), labels_of(colour_ramps()), "Colour ramp",
                                 "The colours of values (intensity, height, an attribute, level, error): " +
                                     descriptions_of(colour_ramps()) + ". Default Automatic."));
    parameters.addParam(
        RichString(range, "", "Colour range",
                   "The values at the ramp's ends, LOW:HIGH, as in 400:450; in the units of the cloud. "
                   "Default: empty, the range of 98 % of the cloud's points. Its ends can be dragged on "
                   "the legend, where a double click asks for numbers and a right click takes the "
                   "default."));
    parameters.addParam(RichBool(legend, true, "Legend",
                                 "Shows the meaning of the colours in the upper right corner: values of a ramp, or the "
                                 "classes that occur; a click on a class hides its points. Default on."));
    parameters.addParam(RichString(
        conditions, "", "Show only",
        "Only points that satisfy all of these conditions are shown, separated by ; as in classification=2,6; "
        "intensity>=100; z=400..450; rgb[0]!=0. Coordinates are the cloud's own. The cloud is not changed. Default: "
        "empty, all points."));
    parameters.addParam(RichString(hidden_classes, "", "Hidden classes",
                                   "Points of these classes are not shown: numbers from 0 to 255, as in 7, 18. The "
                                   "cloud is not changed. Default: none."));
    const auto byte = [&](std::size_t i) { return qRound(255 * style.uniform_colour[i]); };
    parameters.addParam(RichColor(uniform_colour, QColor(byte(0), byte(1), byte(2)), "Uniform colour",
                                  "Colour of all points if Colour by is Uniform. Default light grey."));
    parameters.addParam(
        RichFloat(brightness, style.brightness, "Brightness",
                  "Factor on the points' own colours (Colour by RGB), from 0.01 to 100, for scans whose "
                  "colours are dark. Default 1."));
    parameters.addParam(RichFloat(gamma_value, style.gamma, "Gamma",
                                  "Makes the dark ones of the points' own colours (Colour by RGB) lighter where it is "
                                  "above 1, and bright ones little: a colour from 0 to 1 is raised to 1 / gamma, after "
                                  "the brightness. From 0.1 to 10. Default 1."));
}

ColourSettings read_colour_settings(const RichParameterList& parameters, CloudStyle& style)
{
    ColourSettings settings;
    style.colour = static_cast<ColourMode>(choice_of(parameters, colour, colour_modes()));
    style.attribute = parameters.getString(attribute).trimmed().toStdString();
    style.ramp = static_cast<ColourRamp>(choice_of(parameters, ramp, colour_ramps()));
    const QColor uniform = parameters.getColor(uniform_colour);
    style.uniform_colour = {static_cast<float>(uniform.redF()), static_cast<float>(uniform.greenF()),
                            static_cast<float>(uniform.blueF())};
    style.brightness = std::clamp(parameters.getFloat(brightness), 0.01f, 100.0f);
    style.gamma = std::clamp(parameters.getFloat(gamma_value), 0.1f, 10.0f);
    settings.legend = parameters.getBool(legend);
    const QString ends = parameters.getString(range).simplified().remove(' ');
    if (!ends.isEmpty())
        attempt(settings.problem, "Colour range", [&] { style.range = parse_value_range(ends.toStdString()); });
    for (const QString& text : parameters.getString(conditions).split(';', Qt::SkipEmptyParts))
        if (!text.trimmed().isEmpty())
            attempt(settings.problem, "Show only",
                    [&] { style.where.push_back(parse_condition(text.trimmed().toStdString())); });
    settings.hidden_classes = classes_of(parameters.getString(hidden_classes), settings.problem);
    if (!settings.hidden_classes.empty())
        style.where.push_back(
            parse_condition("classification!=" + text_of(settings.hidden_classes).remove(' ').toStdString()));
    return settings;
}

void toggle_class(RichParameterList& parameters, unsigned number)
{
    QString ignored;
    std::set<unsigned> classes = classes_of(parameters.getString(hidden_classes), ignored);
    if (!classes.erase(number)) classes.insert(number);
    parameters.setValue(hidden_classes, StringValue(text_of(classes)));
}

void set_range(RichParameterList& parameters, const QString& ends) { parameters.setValue(range, StringValue(ends)); }

}  // namespace pcm::host
