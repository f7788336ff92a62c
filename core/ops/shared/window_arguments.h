// Arguments of dialogs alone: what only a window has.
#pragma once

#include "pcm/cloud/selection.h"
#include "pcm/ops/operation.h"

namespace pcm::ops {

// in_clip: only points that the window's clip box shows.
struct ClipArgument {
    bool in_clip = true;
    void declare(Arguments& arguments)
    {
        arguments.add("in_clip", in_clip)
            .only(Face::dialog)
            .label("Only what the clip box shows")
            .help(
                "Where the project has a clip box that is switched on, and the current layer shows the tree, only "
                "points that it shows count");
    }
    void add_to(Selection& selection, const Context& context) const
    {
        if (in_clip && context.window.clip) selection.clips.push_back(*context.window.clip);
    }
};

}  // namespace pcm::ops
