#include "plugin/panels/ask_unit.h"

#include "plugin/scene/project_unit.h"

#include <QInputDialog>

#include <algorithm>

namespace pcm::host {

std::optional<std::string> ask_unit(Scene& scene, QWidget* parent)
{
    if (const auto known = chosen_unit(scene)) return known;
    QStringList words;
    for (const UnitChoice& choice : unit_choices) words << choice.words;
    bool good = false;
    const QString said = QInputDialog::getItem(parent, "Unit of the project",
                                               "The clouds do not state what one unit of their coordinates is.\nThe "
                                               "answer is kept in the project; numbers are "
                                               "never converted.",
                                               words, 0, false, &good);
    if (!good) return std::nullopt;
    choose_unit(scene, unit_choices[std::max(0, words.indexOf(said))].symbol);
    return chosen_unit(scene);
}

}  // namespace pcm::host
