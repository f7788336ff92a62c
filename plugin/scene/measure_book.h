// The measures of a scene. Views show them whichever tool is active, and project files keep them. GUI thread.
//
// Positions are those of the scene (scene/annotations.h): source coordinates, or what a layer's matrix makes of them.
#pragma once

#include "pcm/measure/measure_list.h"
#include "plugin/scene/length_unit.h"
#include "plugin/scene/list_book.h"

namespace pcm::host {

class MeasureBook : public ListBook<MeasureList> {
    Q_OBJECT

public:
    explicit MeasureBook(Scene& scene);

    // The unit when the list was last shown, or refresh_unit() was called.
    const LengthUnit& unit() const { return unit_; }
    void refresh_unit();

private:
    void show() override;

    LengthUnit unit_;
};

// Makes project files keep the measures of documents, as the element PointCloudMeasures. Once per program.
void keep_measures_in_projects();

}  // namespace pcm::host
