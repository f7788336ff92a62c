#include "plugin/host/project_unit.h"

#include "pcm/system/error.h"
#include "plugin/host/project_parts.h"

#include <QInputDialog>

#include <algorithm>
#include <utility>

namespace pcm::host {

namespace {

const char* const unit_element = "PointCloudLengthUnit";
const char* const unit_property = "pcm_length_unit";  // of the document
const char* const not_known = "unknown";              // in projects, where an empty text is no element

bool is_choice(const std::string& symbol)
{
    return std::any_of(std::begin(unit_choices), std::end(unit_choices),
                       [&](const UnitChoice& choice) { return symbol == choice.symbol; });
}

}  // namespace

std::optional<std::string> chosen_unit(const MeshDocument& document)
{
    const QVariant kept = document.property(unit_property);
    return kept.isValid() ? std::optional(kept.toString().toStdString()) : std::nullopt;
}

void choose_unit(MeshDocument& document, const std::string& symbol)
{
    if (!is_choice(symbol))
        throw Error(ErrorCode::invalid_argument, {}, "'" + symbol + "' is not a unit that a project can have",
                    "m, ft, ftUS, or unknown");
    document.setProperty(unit_property, QString::fromStdString(symbol));
}

std::optional<std::string> ask_unit(MeshDocument& document, QWidget* parent)
{
    if (const auto known = chosen_unit(document)) return known;
    QStringList words;
    for (const UnitChoice& choice : unit_choices) words << choice.words;
    bool good = false;
    const QString said = QInputDialog::getItem(parent, "Unit of the project",
                                               "The clouds do not state what one unit of their coordinates is.\nThe "
                                               "answer is kept in the project; numbers are "
                                               "never converted.",
                                               words, 0, false, &good);
    if (!good) return std::nullopt;
    choose_unit(document, unit_choices[std::max(0, words.indexOf(said))].symbol);
    return chosen_unit(document);
}

void keep_units_in_projects()
{
    static bool once = false;
    if (std::exchange(once, true)) return;
    add_project_part({unit_element,
                      [](MeshDocument& document) {
                          const auto unit = chosen_unit(document);
                          return !unit ? QString() : unit->empty() ? not_known : QString::fromStdString(*unit);
                      },
                      [](MeshDocument& document, const QString& text) {
                          const QString symbol = text.trimmed();
                          choose_unit(document, symbol == not_known ? std::string() : symbol.toStdString());
                      }});
}

}  // namespace pcm::host
