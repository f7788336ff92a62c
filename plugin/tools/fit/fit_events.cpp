// Keys of the tool Fit Primitives.
#include "plugin/tools/fit/fit_tool.h"

namespace pcm::host {

void FitTool::press_key(ListKey key)
{
    using Button = FitPanel::Button;
    press(key == ListKey::undo   ? Button::undo
          : key == ListKey::redo ? Button::redo
          : key == ListKey::copy ? Button::copy
                                 : Button::remove);
}

}  // namespace pcm::host
