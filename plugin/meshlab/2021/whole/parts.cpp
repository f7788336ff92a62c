#include "plugin/meshlab/2021/whole/parts.h"

#include <QCoreApplication>

namespace pcm::host {

namespace {

std::vector<MakePart>& parts()
{
    static std::vector<MakePart> all;
    return all;
}

}  // namespace

void tell_python(FilterPlugin& filters)
{
    if (!QCoreApplication::instance()) pymeshlab::functionSetInstance().loadFilterPlugin(&filters);
}

void tell_window(DecoratePlugin& decorator)
{
    RichParameterList* const settings = window_settings();
    if (!settings) return;
    RichParameterList wanted;
    for (QAction* action : decorator.actions()) decorator.initGlobalParameterList(action, wanted);
    for (const RichParameter& parameter : wanted)
        if (!settings->hasParameter(parameter.name())) settings->addParam(parameter);
}

bool add_part(MakePart make)
{
    parts().push_back(make);
    return true;
}

std::vector<std::unique_ptr<Part>> make_parts()
{
    std::vector<std::unique_ptr<Part>> made;
    for (const MakePart make : parts()) made.push_back(make());
    return made;
}

}  // namespace pcm::host
