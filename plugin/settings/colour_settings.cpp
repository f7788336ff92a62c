#include "plugin/settings/colour_settings.h"

#include "pcm/cloud/condition.h"
#include "plugin/scene/text.h"
#include "plugin/settings/choices.h"

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

void add_colour_settings(Parameters& parameters)
{
    const CloudStyle style;
    parameters.add({colour, static_cast<int>(style.colour), "Colour by",
                    "What the colour of a point shows: " + descriptions_of(colour_modes()) +
                        ". A cloud whose colours are absent or all the same shows its classes, and one "
                        "without these its height, with the intensity as brightness where that shows "
                        "shape. Default RGB.",
                    labels_of(colour_modes())});
    parameters.add({attribute, QString(), "Attribute",
                    "With Colour by Attribute: the name of the attribute, such as gps_time or "
                    "return_number, or of one of its components, such as normal[2]. Tree Information "
                    "lists the names. Default: none."});
    parameters.add({ramp, static_cast<int>(style.ramp), "Colour ramp",
                    "The colours of values (intensity, height, an attribute, level, error): " +
                        descriptions_of(colour_ramps()) + ". Default Automatic.",
                    labels_of(colour_ramps())});
    parameters.add({range, QString(), "Colour range",
                    "The values at the ramp's ends, LOW:HIGH, as in 400:450; in the units of the cloud. "
                    "Default: empty, the range of 98 % of the cloud's points. Its ends can be dragged on "
                    "the legend, where a double click asks for numbers and a right click takes the "
                    "default."});
    parameters.add({legend, true, "Legend",
                    "Shows the meaning of the colours in the upper right corner: values of a ramp, or the "
                    "classes that occur; a click on a class hides its points. Default on."});
    parameters.add(
        {conditions, QString(), "Show only",
         "Only points that satisfy all of these conditions are shown, separated by ; as in classification=2,6; "
         "intensity>=100; z=400..450; rgb[0]!=0. Coordinates are the cloud's own. The cloud is not changed. Default: "
         "empty, all points."});
    parameters.add({hidden_classes, QString(), "Hidden classes",
                    "Points of these classes are not shown: numbers from 0 to 255, as in 7, 18. The "
                    "cloud is not changed. Default: none."});
    const auto byte = [&](std::size_t i) { return qRound(255 * style.uniform_colour[i]); };
    parameters.add({uniform_colour, QColor(byte(0), byte(1), byte(2)), "Uniform colour",
                    "Colour of all points if Colour by is Uniform. Default light grey."});
    parameters.add({brightness, style.brightness, "Brightness",
                    "Factor on the points' own colours (Colour by RGB), from 0.01 to 100, for scans whose "
                    "colours are dark. Default 1."});
    parameters.add({gamma_value, style.gamma, "Gamma",
                    "Makes the dark ones of the points' own colours (Colour by RGB) lighter where it is "
                    "above 1, and bright ones little: a colour from 0 to 1 is raised to 1 / gamma, after "
                    "the brightness. From 0.1 to 10. Default 1."});
}

ColourSettings read_colour_settings(const Parameters& parameters, CloudStyle& style)
{
    ColourSettings settings;
    style.colour = static_cast<ColourMode>(choice_of(parameters, colour, colour_modes()));
    style.attribute = parameters.text(attribute).trimmed().toStdString();
    style.ramp = static_cast<ColourRamp>(choice_of(parameters, ramp, colour_ramps()));
    const QColor uniform = parameters.colour(uniform_colour);
    style.uniform_colour = {static_cast<float>(uniform.redF()), static_cast<float>(uniform.greenF()),
                            static_cast<float>(uniform.blueF())};
    style.brightness = std::clamp(parameters.real(brightness), 0.01f, 100.0f);
    style.gamma = std::clamp(parameters.real(gamma_value), 0.1f, 10.0f);
    settings.legend = parameters.flag(legend);
    const QString ends = parameters.text(range).simplified().remove(' ');
    if (!ends.isEmpty())
        attempt(settings.problem, "Colour range", [&] { style.range = parse_value_range(ends.toStdString()); });
    for (const QString& text : parameters.text(conditions).split(';', Qt::SkipEmptyParts))
        if (!text.trimmed().isEmpty())
            attempt(settings.problem, "Show only",
                    [&] { style.where.push_back(parse_condition(text.trimmed().toStdString())); });
    settings.hidden_classes = classes_of(parameters.text(hidden_classes), settings.problem);
    if (!settings.hidden_classes.empty())
        style.where.push_back(
            parse_condition("classification!=" + text_of(settings.hidden_classes).remove(' ').toStdString()));
    return settings;
}

void toggle_class(SettingStore& settings, unsigned number)
{
    QString ignored;
    std::set<unsigned> classes = classes_of(settings.value(hidden_classes).value_or(QString()).toString(), ignored);
    if (!classes.erase(number)) classes.insert(number);
    settings.set(hidden_classes, text_of(classes));
}

void set_range(SettingStore& settings, const QString& ends) { settings.set(range, ends); }

}  // namespace pcm::host
