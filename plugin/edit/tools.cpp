#include "plugin/edit/tools.h"

#include "plugin/edit/icon.h"
#include "plugin/edit/walk/first_person_tool.h"

namespace pcm::host {

namespace {

template <class T>
MeshEditInterface* make()
{
    return new T;
}

}  // namespace

const std::vector<Tool>& tools()
{
    static const std::vector<Tool> table{
        {"First Person Navigation",
         "Walk through the scene: W A S D and E Q move, Shift moves faster, dragging looks around, the wheel changes "
         "the "
         "speed. The speed is proportional to the distance of the nearest points.",
         first_person_icon, make<FirstPersonTool>},
    };
    return table;
}

}  // namespace pcm::host
