// Set Clip Box: what is shown of all point clouds of the document.
#include "pcm/cloud/vector.h"
#include "pcm/ops/operation.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "plugin/filter/filter.h"
#include "plugin/scene/scene_state.h"
#include "plugin/scene/selection_text.h"

#include <cmath>

namespace pcm::host {

namespace {

enum Mode { inside, outside, off };

void add_parameters(Parameters& parameters)
{
    parameters.add({"Mode",
                    int(inside),
                    "Mode",
                    "Whether the points in the box are shown alone, or hidden, or the box is switched off. Default: "
                    "shown alone.",
                    {"Show what is in it", "Hide what is in it", "Off"}});
    parameters.add({"Box", QString(), "Box",
                    "Its smallest x y z and its largest x y z, six numbers separated by blanks, in source coordinates "
                    "and units, bounds included. Empty, the default: the clip box that the document has."});
    parameters.add({"Turn", 0.0f, "Turn (degrees)",
                    "Turns that box about its centre, counter-clockwise seen from above, in degrees. Default 0."});
}

// Throws Error(invalid_argument).
ClipBox box_of(const Parameters& parameters)
{
    const auto box = *parse_selection(parameters.text("Box"), "").box;
    ClipBox clip;
    for (std::size_t a = 0; a < 3; ++a) {
        if (!(box.max[a] > box.min[a]) || !std::isfinite(box.max[a] - box.min[a]))
            throw Error(
                ErrorCode::invalid_argument, {},
                std::string("the box goes from ") + exact(box.min[a]) + " to " + exact(box.max[a]) + " in " + "xyz"[a],
                "give the smaller number first; a clip box has no side of length 0");
        clip.half[a] = (box.max[a] - box.min[a]) / 2;
        clip.centre[a] = box.min[a] + clip.half[a];
    }
    const double turn = static_cast<double>(parameters.real("Turn")) * pi / 180;
    if (turn != 0)
        clip.axes = {Vec3d{std::cos(turn), std::sin(turn), 0}, Vec3d{-std::sin(turn), std::cos(turn), 0},
                     Vec3d{0, 0, 1}};
    return clip;
}

void run(const FilterRun& run)
{
    SceneState& scene = run.scene.part<SceneState>();
    const auto mode = static_cast<Mode>(run.parameters.whole("Mode"));
    const bool has_box = !run.parameters.text("Box").trimmed().isEmpty();
    std::optional<ClipBox> clip = scene.clip();
    if (has_box) clip = box_of(run.parameters);
    if (!clip && mode != off)
        throw Error(ErrorCode::invalid_argument, {}, "the document has no clip box yet", "give a box");
    if (clip) {
        clip->enabled = mode != off;
        if (mode != off) clip->outside = mode == outside;
    }
    scene.set_clip(clip);
    if (!clip || mode == off)
        run.log("The clip box is off: all points are shown.");
    else
        run.log(std::string(mode == outside ? "Hidden" : "Shown alone") + ": the points in the clip box around " +
                exact(clip->centre) + " with the sides " + exact(2.0 * clip->half) + ".");
}

}  // namespace

Filter set_clip_box()
{
    return {"Set Clip Box",
            "Shows only a part of all <b>point clouds</b> of the project: what is in a box, or what is not. No point "
            "is changed; filters and exports take all points unless they say otherwise. The tool <i>Clip Box</i> does "
            "the same with the mouse.",
            ops::menu::points | camera_menu, add_parameters, run};
}

}  // namespace pcm::host
