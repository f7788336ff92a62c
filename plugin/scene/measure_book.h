// The measures of a scene. Views show them whichever tool is active, and project files keep them. GUI thread.
//
// Positions are those of the scene (scene/annotations.h): source coordinates, or what a layer's matrix makes of them.
#pragma once

#include "plugin/scene/scene.h"

#include "pcm/measure/measure_list.h"
#include "plugin/scene/length_unit.h"

#include <QObject>

#include <functional>
#include <optional>

namespace pcm::host {

class MeasureBook : public QObject {
    Q_OBJECT

public:
    explicit MeasureBook(Scene& scene);

    const MeasureList& list() const { return list_; }
    // Passes on what `step` throws; the list is then as it was.
    void change(const std::function<void(MeasureList& list)>& step);
    // In place of the present ones, which cannot be had back.
    void replace(MeasureList list);

    // The one that is shown in another colour, whose numbers the panels show.
    std::optional<std::size_t> selected() const { return selected_; }
    void select(std::optional<std::size_t> index);

    // As it was when the list was shown last, or refresh_unit() was called.
    const LengthUnit& unit() const { return unit_; }
    void refresh_unit();

signals:
    void changed();  // the list, the selection or the unit

private:
    void show();

    Scene& scene_;
    MeasureList list_;
    std::optional<std::size_t> selected_;
    LengthUnit unit_;
};

// Makes project files keep the measures of documents, as the element PointCloudMeasures. Once per program.
void keep_measures_in_projects();

}  // namespace pcm::host
