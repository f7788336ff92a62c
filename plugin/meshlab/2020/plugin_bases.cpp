#include "plugin/meshlab/2020/plugin_bases.h"

#include <cstdio>

namespace pcm::host {

namespace {

void add_all(RichParameterList& list, const RichParameterList& more)
{
    for (const RichParameter& parameter : more) list.addParam(parameter);
}

// Newer ones take the exception; this one a text and false.
template <class Work>
bool is_done(QString& error, const Work& work)
{
    error.clear();
    try {
        work();
        return true;
    } catch (const Failure& failure) {
        error = failure.text;
        return false;
    }
}

}  // namespace

void IoBase::initGlobalParameterSet(QAction*, RichParameterList& parameters) { add_global_parameters(parameters); }

void IoBase::initPreOpenParameter(const QString& format, const QString& file_name, RichParameterList& parameters)
{
    add_all(parameters, parameters_before_open(format, file_name));
}

void IoBase::initSaveParameter(const QString& format, MeshModel& layer, RichParameterList& parameters)
{
    add_all(parameters, save_parameters(format, layer));
}

void IoBase::GetExportMaskCapability(QString& format, int& capability, int& defaults) const
{
    exportMaskCapability(format, capability, defaults);
}

bool IoBase::open(const QString& format, const QString& file_name, MeshModel& layer, int& mask,
                  const RichParameterList& parameters, vcg::CallBackPos* callback, QWidget*)
{
    return is_done(errorMessage, [&] { open_layer(format, file_name, layer, mask, parameters, callback); });
}

bool IoBase::save(const QString& format, const QString& file_name, MeshModel& layer, const int mask,
                  const RichParameterList& parameters, vcg::CallBackPos* callback, QWidget*)
{
    return is_done(errorMessage, [&] { save_layer(format, file_name, layer, mask, parameters, callback); });
}

void IoBase::say(GLLogStream::Levels level, const std::string& line, bool has_window)
{
    Log(level, line);
    if (has_window) return;
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
}

void FilterBase::initParameterSet(QAction* action, MeshDocument& document, RichParameterList& parameters)
{
    add_all(parameters, parameters_for(action, document));
}

bool FilterBase::applyFilter(QAction* action, MeshDocument& document, const RichParameterList& parameters,
                             vcg::CallBackPos* callback)
{
    return is_done(errorMessage, [&] { run(action, document, parameters, callback); });
}

}  // namespace pcm::host
