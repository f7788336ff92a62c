#include "plugin/scene/project_unit.h"

#include "pcm/system/error.h"
#include "plugin/scene/project_parts.h"

#include <QVariant>

#include <algorithm>
#include <utility>

namespace pcm::host {

namespace {

const char* const unit_element = "PointCloudLengthUnit";
const char* const unit_property = "pcm_length_unit";  // property of the document
const char* const not_known = "unknown";              // in projects, where an element cannot be empty

bool is_choice(const std::string& symbol)
{
    return std::any_of(std::begin(unit_choices), std::end(unit_choices),
                       [&](const UnitChoice& choice) { return symbol == choice.symbol; });
}

}  // namespace

std::optional<std::string> chosen_unit(const Scene& scene)
{
    const QVariant kept = scene.property(unit_property);
    return kept.isValid() ? std::optional(kept.toString().toStdString()) : std::nullopt;
}

void choose_unit(Scene& scene, const std::string& symbol)
{
    if (!is_choice(symbol))
        throw Error(ErrorCode::invalid_argument, {}, "'" + symbol + "' is not a unit that a project can have",
                    "m, ft, ftUS, or unknown");
    scene.setProperty(unit_property, QString::fromStdString(symbol));
}

void keep_units_in_projects()
{
    static bool once = false;
    if (std::exchange(once, true)) return;
    add_project_part({unit_element,
                      [](Scene& scene) {
                          const auto unit = chosen_unit(scene);
                          return !unit ? QString() : unit->empty() ? not_known : QString::fromStdString(*unit);
                      },
                      [](Scene& scene, const QString& text) {
                          const QString symbol = text.trimmed();
                          choose_unit(scene, symbol == not_known ? std::string() : symbol.toStdString());
                      }});
}

}  // namespace pcm::host
