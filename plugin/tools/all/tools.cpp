#include "plugin/tools/all/tools.h"

#include "plugin/tools/align/align_tool.h"
#include "plugin/tools/clip/clip_tool.h"
#include "plugin/tools/fit/fit_tool.h"
#include "plugin/tools/icon.h"
#include "plugin/tools/measure/measure_tool.h"
#include "plugin/tools/pick/pick_tool.h"
#include "plugin/tools/select/select_tool.h"
#include "plugin/tools/walk/first_person_tool.h"

namespace pcm::host {

namespace {

template <class T>
std::unique_ptr<Tool> make()
{
    return std::make_unique<T>();
}

}  // namespace

const std::vector<ToolRow>& tools()
{
    static const std::vector<ToolRow> table{
        {"First Person Navigation",
         "Walk through the scene: W A S D and E Q move, Shift moves faster, dragging looks around, the wheel changes "
         "the "
         "speed. The speed is proportional to the distance of the nearest points. The eye stays above the ground; G "
         "lets it through.",
         first_person_icon, make<FirstPersonTool>},
        {"Pick Point",
         "A click shows all that a cloud knows about the visible point under the cursor, at full resolution: source "
         "coordinates with every digit, every attribute, spacing. Ctrl+C copies it.",
         pick_point_icon, make<PickTool>},
        {"Clip Box",
         "A box in the view that hides all points outside or inside of it: dragged by its handles, typed, or taken "
         "from "
         "the view or from two points; a slab that moves through the clouds. The clouds are not changed.",
         clip_box_icon, make<ClipTool>},
        {"Measure",
         "Distances, heights, angles, areas, profiles and volumes between points that are clicked, with their "
         "uncertainty, in source coordinates. The list of measures is kept in the project and exported as CSV, GeoJSON "
         "and DXF.",
         measure_icon, make<MeasureTool>},
        {"Select Points",
         "Selects points of the cloud itself, not of its sample: by a rectangle, a polygon, a brush, by growing, or by "
         "conditions on attributes. What is selected can be extracted, deleted, classified or saved as an attribute.",
         select_points_icon, make<SelectTool>},
        {"Fit Primitives",
         "A click on a surface fits a plane, cylinder, sphere, cone or torus to the points around it and follows it "
         "through the whole cloud. The list of primitives, with their standard deviations, is kept in the project and "
         "exported as DXF, SCR, CSV and JSON; their points are extracted, deleted or saved as an attribute.",
         fit_icon, make<FitTool>},
        {"Align by Picked Pairs",
         "Moves one point cloud to another by three or more pairs of points that are picked in the view: residuals, "
         "uncertainty, the layer's matrix with undo, or a new tree moved in double.",
         align_icon, make<AlignTool>},
    };
    return table;
}

}  // namespace pcm::host
